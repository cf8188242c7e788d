// Sources: [IwanickiSloan2012, Sec. 3.2-3.3] for the variants, [Sloan2008] and [Sloan2017] for windows.
#include "compress/tables/table_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/math/sh_window.h"

namespace prt {
namespace {

constexpr const char* kPaper = "paper";
constexpr const char* kNoWindow = "none";
constexpr double kWidestWindow = 1000;

struct Window {
    ShWindow kind;
    std::optional<double> width;  ///< bands
    bool isAuto = false;          ///< as wide as leaves nothing negative
};

std::optional<Window> parseWindow(const std::string& text) {
    if (text == kNoWindow) return std::nullopt;
    const size_t colon = text.find(':');
    const std::string name = text.substr(0, colon);
    const auto refuse = [&](const std::string& problem) {
        throw UsageError("--window", problem,
                         "use none, hanning, lanczos or gaussian, NAME:WIDTH or NAME:auto");
    };
    Window window{};
    if (name == "hanning")
        window.kind = ShWindow::Hanning;
    else if (name == "lanczos")
        window.kind = ShWindow::Lanczos;
    else if (name == "gaussian")
        window.kind = ShWindow::Gaussian;
    else
        refuse(fmt::format("there is no window called '{}'", name));
    if (colon == std::string::npos) return window;
    window.isAuto = text.substr(colon + 1) == "auto";
    if (window.isAuto) return window;
    double width = 0;
    const char* const end = text.data() + text.size();
    const auto [last, error] = std::from_chars(text.data() + colon + 1, end, width);
    if (error != std::errc() || last != end || !(width > 0 && width <= kWidestWindow))
        refuse(fmt::format("'{}' is no width of more than 0 and at most {} bands", text.substr(colon + 1),
                           kWidestWindow));
    window.width = width;
    return window;
}

}  // namespace

const std::vector<std::string>& tableVariantNames() {
    static const std::vector<std::string> all = {"exact", kPaper};
    return all;
}

int TableOptions::cosineBands() const { return variant == kPaper ? kPaperCosineBands : kTableCosineBands; }

void checkTableOptions(const TableOptions& options, const std::string& prefix) {
    const auto check = [&](const char* option, const std::string& value, const char* what,
                           const std::vector<std::string>& names) {
        if (std::find(names.begin(), names.end(), value) == names.end())
            throw UsageError(prefix + option, fmt::format("there is no {} called '{}'", what, value),
                             fmt::format("use {}", fmt::join(names, ", ")));
    };
    check("layout", options.layout, "layout", TableLayout::names());
    check("variant", options.variant, "variant", tableVariantNames());
    const int least = TableLayout::minSize(options.layout);
    if (options.size < least || options.size > TableLayout::kMaxSize)
        throw UsageError(prefix + "size", fmt::format("{} is out of range", options.size),
                         fmt::format("use {} to {}", least, TableLayout::kMaxSize));
    parseWindow(options.window);
}

std::string tableWords(const TableOptions& options) {
    std::string words = fmt::format(" --layout {} --size {}", options.layout, options.size);
    const TableOptions defaults;
    if (options.variant != defaults.variant) words += " --variant " + options.variant;
    if (options.window != defaults.window) words += " --window " + options.window;
    if (options.extractSun) words += " --extract-sun";
    return words;
}

double applyTableWindow(const TableOptions& options, EnvironmentSh& environment) {
    const std::optional<Window> window = parseWindow(options.window);
    if (!window) return 0;
    // Variants that need fewer bands of the light get the same window.
    const double all = environment.shOrder - options.cosineBands() + kTableCosineBands;
    const double width = window->width    ? *window->width
                         : window->isAuto ? findNonNegativeWindow(environment, window->kind)
                                          : all;
    applyShWindow(window->kind, width, environment);
    return width;
}

TableLight projectTableLight(const LatLongView& image, int shOrder, const TableOptions& options) {
    const int order = options.environmentShOrder(shOrder);
    TableLight light;
    if (options.extractSun) {
        const SunExtraction extraction = extractSun(image);
        light.sun = extraction.sun;
        light.rest = projectEnvironment({image.width, image.height, extraction.rest}, order);
    } else {
        light.rest = projectEnvironment(image, order);
    }
    light.windowWidth = applyTableWindow(options, light.rest);
    return light;
}

}  // namespace prt
