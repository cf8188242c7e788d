#include "tools/measure/figure.h"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include "precompute/base/atomic_file.h"
#include "precompute/base/check.h"
#include "precompute/base/error.h"

namespace prt::tools {
namespace {

// Distinguishable with every common colour blindness [Okabe & Ito 2002], black for the tenth and later
// series.
constexpr const char* kColours[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00",
                                    "#56b4e9", "#7f3c8d", "#8c6d31", "#666666", "#000000"};
constexpr size_t kColourCount = std::size(kColours);

/// In double quotes, as gnuplot reads them; markup of its "enhanced" text is switched off.
std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        out += c == '\n' ? ' ' : c;
    }
    return out + '"';
}

std::string number(double value, bool logarithmic) {
    return std::isfinite(value) && (!logarithmic || value > 0) ? fmt::format("{}", value) : "NaN";
}

std::string axes(const Panel& panel) {
    std::string out;
    out += panel.logX ? "set logscale x\n" : "unset logscale x\n";
    out += panel.logY ? "set logscale y\nset format y \"%.0e\"\n" : "unset logscale y\nset format y \"%g\"\n";
    out += fmt::format("set xlabel {} offset 0,0.5\nset ylabel {}\nset rmargin 4\n", quoted(panel.xLabel),
                       quoted(panel.yLabel));
    return out +
           "set xtics autofreq norotate nomirror\nset ytics nomirror\nset autoscale\nset grid lc rgb "
           "\"#dddddd\"\nset border 3\n";
}

std::string curves(const Panel& panel, size_t index) {
    std::string data, plot;
    for (size_t s = 0; s < panel.series.size(); ++s) {
        const Series& series = panel.series[s];
        data += fmt::format("$p{}s{} << EOD\n", index, s);
        for (const auto& [x, y] : series.points)
            data += number(x, panel.logX) + ' ' + number(y, panel.logY) + '\n';
        data += "EOD\n";
        plot += fmt::format(
            "{}$p{}s{} using 1:2 with linespoints lc rgb \"{}\" lw 1.6 dt {} pt {} ps 0.55 title {}",
            s == 0 ? "plot " : ", \\\n  ", index, s, kColours[std::min(s, kColourCount - 1)],
            series.dashed ? 2 : 1, 1 + int(s % 13), quoted(series.name));
    }
    return data + axes(panel) + "set key below maxrows 4 samplen 2 height 1\n" + plot + "\n";
}

std::string bars(const Panel& panel, size_t index) {
    std::string data = fmt::format("$p{} << EOD\n", index);
    double lowest = std::numeric_limits<double>::infinity();
    for (const Bar& bar : panel.bars) {
        if (bar.value > 0) lowest = std::min(lowest, bar.value);
        data += fmt::format("{} {} {}\n", quoted(bar.name), number(bar.value, panel.logY), bar.group);
    }
    data += "EOD\n";
    std::string out =
        data + axes(panel) + "unset key\nset style fill solid 0.85 noborder\nset boxwidth 0.7\n";
    out += fmt::format("set xtics rotate by -40 nomirror\nset xrange [-0.7:{}]\n",
                       double(panel.bars.size()) - 0.3);
    if (!panel.logY)
        out += "set yrange [0:*]\n";
    else if (std::isfinite(lowest))
        out += fmt::format("set yrange [{}:*]\n", lowest / 2);
    out += fmt::format("plot for [g=0:{}] $p{} using 0:(column(3)==g ? column(2) : NaN):xtic(1) with boxes ",
                       kColourCount - 1, index);
    return out + "lc rgb word(colours, g + 1)\n";
}

std::string surface(const Panel& panel, size_t index) {
    const Surface& s = panel.surface;
    PRT_CHECK_EQ(s.points.size(), size_t(s.rows) * size_t(s.columns));
    std::string data = fmt::format("$p{} << EOD\n", index);
    for (int row = 0; row < s.rows; ++row) {
        for (int column = 0; column < s.columns; ++column) {
            const auto& p = s.points[size_t(row * s.columns + column)];
            data += fmt::format("{:.4g} {:.4g} {:.4g} {:.4g}\n", p[0], p[1], p[2], p[3]);
        }
        data += '\n';
    }
    data += "EOD\nunset border\nunset tics\nunset key\nunset xlabel\nunset ylabel\nset view 60, 40, 1.6\n";
    data += "unset logscale\nset view equal xyz\nset xrange [-1:1]\nset yrange [-1:1]\nset zrange [-1:1]\n";
    data += "set pm3d depthorder border lc rgb \"#444444\" lw 0.15\nunset colorbox\n";
    data += "set palette defined (-1 \"#2166ac\", -0.001 \"#92c5de\", 0.001 \"#f4a582\", 1 \"#b2182b\")\n";
    return data + fmt::format("set cbrange [-1:1]\nsplot $p{} using 1:2:3:4 with pm3d\n", index);
}

std::string panelScript(const Panel& panel, size_t index) {
    if (panel.surface.points.empty() && panel.series.empty() && panel.bars.empty())
        return "set multiplot next\n";
    std::string out = fmt::format("set title {} font \",11\"\n", quoted(panel.title));
    if (!panel.surface.points.empty()) return out + surface(panel, index);
    return out + (panel.bars.empty() ? curves(panel, index) : bars(panel, index));
}

bool gnuplotInstalled() {
    const char* path = std::getenv("PATH");
    std::istringstream folders(path ? path : "");
    for (std::string folder; std::getline(folders, folder, ':');)
        if (::access((folder + "/gnuplot").c_str(), X_OK) == 0) return true;
    return false;
}

}  // namespace

std::string gnuplotScript(const Figure& figure, const std::string& format, const std::string& path) {
    const int columns = std::max(1, figure.columns);
    const int rows = (int(figure.panels.size()) + columns - 1) / columns;
    std::string out = fmt::format(
        "set encoding utf8\nset terminal {} size {},{} noenhanced font \"DejaVu Sans,10\" background rgb "
        "\"white\"\n",
        format == "png" ? "pngcairo" : "svg", columns * figure.panelWidthPx,
        rows * figure.panelHeightPx + 40);
    out += fmt::format("set output {}\ncolours = \"{}\"\n", quoted(path), fmt::join(kColours, " "));
    out += fmt::format("set multiplot layout {},{} rowsfirst title {} font \",13\"\n", rows, columns,
                       quoted(figure.title));
    for (size_t p = 0; p < figure.panels.size(); ++p) out += panelScript(figure.panels[p], p);
    return out + "unset multiplot\nunset output\n";
}

bool drawFigure(const Figure& figure, const std::string& format, const std::string& path) {
    if (!gnuplotInstalled()) return false;
    AtomicFile file(path);
    const std::string script = gnuplotScript(figure, format, file.temporaryPath().string());
    FILE* pipe = ::popen("gnuplot 2>/dev/null", "w");
    if (!pipe) throw OutputError(path, "gnuplot cannot be started");
    const bool written = std::fwrite(script.data(), 1, script.size(), pipe) == script.size();
    const int status = ::pclose(pipe);
    if (!written || !WIFEXITED(status) || WEXITSTATUS(status) != 0)
        throw OutputError(path, "gnuplot could not draw it",
                          "see that the disk has room, or leave it out: --plot none");
    file.commit();
    return true;
}

}  // namespace prt::tools
