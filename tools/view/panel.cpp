// Sources: Dear ImGui 1.86.
#include "tools/view/panel.h"

#include <backends/imgui_impl_opengl3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace prt::tools {
namespace {

constexpr float kFontPixels = 15, kMargin = 8, kPanelWidth = 300;
constexpr double kDegreesPerRad = 180 / std::numbers::pi;

ImVec4 displayColour(const Vec3f& linear) {
    const ByteImage shown = toDisplay({1, 1, 3, {linear.x(), linear.y(), linear.z()}}, 0);
    return ImVec4(float(shown.pixels[0]) / 255, float(shown.pixels[1]) / 255, float(shown.pixels[2]) / 255,
                  1);
}

void row(const char* name, const std::string& value) {
    ImGui::TextUnformatted(name);
    ImGui::SameLine(ImGui::GetWindowContentRegionWidth() * 0.46f);
    ImGui::TextUnformatted(value.c_str());
}

void hint(const char* text) {
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", text);
}

void techniqueSection(const ViewChoices& choices, ViewState& state) {
    const std::string name = techniqueName(choices.techniques[state.technique]);
    if (ImGui::BeginCombo("technique", name.c_str(), ImGuiComboFlags_HeightLargest)) {
        for (size_t i = 0; i < choices.techniques.size(); ++i) {
            const Technique technique = choices.techniques[i];
            if (ImGui::Selectable(techniqueName(technique).c_str(), i == state.technique))
                state.technique = i;
            hint(techniqueSummary(technique).c_str());
        }
        ImGui::EndCombo();
    }
    constexpr const char* kLabels[kShownCount] = {
        "lit",      "PCA weight", "SH coefficient", "ambient occlusion",
        "validity", "charts",     "reference",      "4 x difference"};
    if (ImGui::BeginCombo("show", kLabels[size_t(state.shown)], ImGuiComboFlags_HeightLargest)) {
        for (int i = 0; i < kShownCount; ++i) {
            const std::string why = choices.whyNot(Shown(i));
            if (why.empty()) {
                if (ImGui::Selectable(kLabels[i], state.shown == Shown(i))) state.shown = Shown(i);
            } else {
                ImGui::TextDisabled("%s: %s", kLabels[i], why.c_str());
            }
        }
        ImGui::EndCombo();
    }
    if (const int count = choices.indexCount(state.shown); count > 1) {
        int number = state.index();
        if (ImGui::SliderInt("number", &number, 0, count - 1, "%d", ImGuiSliderFlags_AlwaysClamp))
            state.setIndex(number, choices);
    }
}

void lightSection(const ViewChoices& choices, ViewState& state) {
    float degrees = float(state.rotationRad * kDegreesPerRad);
    if (ImGui::SliderFloat("turn", &degrees, -180, 180, "%.0f deg", ImGuiSliderFlags_AlwaysClamp))
        state.rotationRad = double(degrees) / kDegreesPerRad;
    for (size_t e = 0; e < choices.environments.size(); ++e) {
        ImGui::PushID(int(e));
        bool alone = state.solo == e;
        if (ImGui::Checkbox("##alone", &alone)) {
            if (alone)
                state.solo = e;
            else
                state.solo.reset();
        }
        hint("this environment alone");
        ImGui::SameLine();
        ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x * 0.4f);
        float weight = float(state.weights[e]);
        if (ImGui::SliderFloat("##weight", &weight, 0, 2, "%.2f", ImGuiSliderFlags_NoRoundToFormat)) {
            state.weights[e] = std::max(0.0, double(weight));
            state.solo.reset();
        }
        ImGui::SameLine();
        ImGui::TextUnformatted(choices.environments[e].c_str());
        ImGui::PopID();
    }
}

void pictureSection(const ViewStatistics& statistics, ViewState& state) {
    float stops = float(state.autoExposure ? statistics.exposureStops : state.exposureStops);
    if (ImGui::SliderFloat("exposure", &stops, -10, 10, "%.1f stops", ImGuiSliderFlags_NoRoundToFormat)) {
        state.exposureStops =
            std::clamp(double(stops), -ViewInput::kMostExposureStops, ViewInput::kMostExposureStops);
        state.autoExposure = false;
    }
    if (ImGui::Checkbox("automatic", &state.autoExposure) && !state.autoExposure)
        state.exposureStops = statistics.exposureStops;
    const std::string curve(toneCurveName(state.toneCurve));
    if (ImGui::BeginCombo("tone curve", curve.c_str())) {
        for (const ToneCurve choice : {ToneCurve::None, ToneCurve::Filmic, ToneCurve::Neutral})
            if (ImGui::Selectable(std::string(toneCurveName(choice)).c_str(), choice == state.toneCurve))
                state.toneCurve = choice;
        ImGui::EndCombo();
    }
    bool many = state.samples == 4;
    if (ImGui::Checkbox("4 samples", &many)) state.samples = many ? 4 : 1;
    ImGui::SameLine(ImGui::GetWindowContentRegionWidth() * 0.46f);
    ImGui::Checkbox("background", &state.background);
    ImGui::Checkbox("normal map", &state.normalMap);
}

void statisticsSection(const SceneView& scene, const PanelFacts& facts) {
    const ViewStatistics& statistics = scene.statistics();
    row("frame", fmt::format("{:.1f} ms", statistics.frameMs));
    row("pixels", fmt::format("{} x {}", scene.width(), scene.height()));
    if (facts.framesPerSecond > 0) row("frames", fmt::format("{:.1f} a second", facts.framesPerSecond));
    if (statistics.switches > 0) {
        row("light switch", fmt::format("{:.2f} ms", statistics.switchMs));
        row("a pixel takes", fmt::format("{} fetches", statistics.cost.fetches));
        row("", fmt::format("{} multiply-adds", statistics.cost.multiplyAdds));
    }
    if (statistics.relativeRmse)
        row("relative RMSE", fmt::format("{:.4f}", *statistics.relativeRmse));
    else
        row("reference",
            facts.reference ? fmt::format("{:.0f} %", 100 * *facts.reference) : std::string("none"));
    if (statistics.psnrDb) row("PSNR", fmt::format("{:.1f} dB", *statistics.psnrDb));
}

void legendWindow(const PointColours& colours, const WindowSize& size) {
    ImGui::SetNextWindowPos(ImVec2(kMargin, float(size.height) - kMargin), ImGuiCond_Always, ImVec2(0, 1));
    ImGui::Begin("legend", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoFocusOnAppearing);
    ImGui::TextUnformatted(colours.title.c_str());
    if (colours.continuous) {
        ImDrawList& list = *ImGui::GetWindowDrawList();
        const float height = ImGui::GetTextLineHeight(), part = 10 * height;
        const ImVec2 at = ImGui::GetCursorScreenPos();
        for (size_t i = 0; i + 1 < colours.legend.size(); ++i) {
            const ImU32 left = ImGui::GetColorU32(displayColour(colours.legend[i].colour));
            const ImU32 right = ImGui::GetColorU32(displayColour(colours.legend[i + 1].colour));
            const float x = at.x + part * float(i);
            list.AddRectFilledMultiColor(ImVec2(x, at.y), ImVec2(x + part, at.y + height), left, right, right,
                                         left);
        }
        const float width = part * float(colours.legend.size() - 1);
        ImGui::Dummy(ImVec2(width, height));
        const float start = ImGui::GetCursorPosX();
        for (size_t i = 0; i < colours.legend.size(); ++i) {
            const char* text = colours.legend[i].text.c_str();
            const float share = float(i) / float(colours.legend.size() - 1);
            if (i > 0) ImGui::SameLine();
            ImGui::SetCursorPosX(start + share * (width - ImGui::CalcTextSize(text).x));
            ImGui::TextUnformatted(text);
        }
    } else {
        for (const LegendEntry& entry : colours.legend) {
            ImGui::PushID(entry.text.c_str());
            ImGui::ColorButton("##colour", displayColour(entry.colour), ImGuiColorEditFlags_NoTooltip,
                               ImVec2(ImGui::GetTextLineHeight(), ImGui::GetTextLineHeight()));
            ImGui::SameLine();
            ImGui::TextUnformatted(entry.text.c_str());
            ImGui::PopID();
        }
    }
    ImGui::End();
}

void helpWindow(const WindowSize& size, ViewState& state) {
    ImGui::SetNextWindowPos(ImVec2(0.5f * float(size.width), 0.5f * float(size.height)), ImGuiCond_Always,
                            ImVec2(0.5f, 0.5f));
    ImGui::SetNextWindowSizeConstraints(
        ImVec2(0, 0), ImVec2(float(size.width) - 2 * kMargin, float(size.height) - 2 * kMargin));
    ImGui::SetNextWindowBgAlpha(0.94f);
    ImGui::SetNextWindowFocus();
    ImGui::Begin("keys and mouse", &state.help,
                 ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse);
    if (ImGui::BeginTable("lines", 2, ImGuiTableFlags_SizingFixedFit)) {
        for (const HelpLine& line : helpLines()) {
            ImGui::TableNextColumn();
            ImGui::TextColored(ImVec4(1, 0.85f, 0.45f, 1), "%s", line.keys.c_str());
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(line.help.c_str());
        }
        ImGui::EndTable();
    }
    ImGui::End();
}

void mapKeys(ImGuiIO& io) {
    constexpr std::pair<ImGuiKey_, Key> kMap[] = {{ImGuiKey_Tab, Key::Tab},
                                                  {ImGuiKey_LeftArrow, Key::Left},
                                                  {ImGuiKey_RightArrow, Key::Right},
                                                  {ImGuiKey_UpArrow, Key::Up},
                                                  {ImGuiKey_DownArrow, Key::Down},
                                                  {ImGuiKey_PageUp, Key::PageUp},
                                                  {ImGuiKey_PageDown, Key::PageDown},
                                                  {ImGuiKey_Home, Key::Home},
                                                  {ImGuiKey_End, Key::End},
                                                  {ImGuiKey_Insert, Key::Insert},
                                                  {ImGuiKey_Delete, Key::Delete},
                                                  {ImGuiKey_Backspace, Key::Backspace},
                                                  {ImGuiKey_Space, Key::Space},
                                                  {ImGuiKey_Enter, Key::Enter},
                                                  {ImGuiKey_Escape, Key::Escape},
                                                  {ImGuiKey_A, Key::A},
                                                  {ImGuiKey_C, Key::C},
                                                  {ImGuiKey_V, Key::V},
                                                  {ImGuiKey_X, Key::X},
                                                  {ImGuiKey_Y, Key::Y},
                                                  {ImGuiKey_Z, Key::Z}};
    for (const auto& [name, key] : kMap) io.KeyMap[name] = int(key);
}

}  // namespace

ViewPanel::ViewPanel(const WindowSize& size) {
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;  // no files in the user's folder
    io.LogFilename = nullptr;
    mapKeys(io);
    const double density = size.width > 0 ? double(size.pixelWidth) / size.width : 1;
    ImFontConfig font;
    font.SizePixels = std::round(kFontPixels * float(size.contentScale));
    io.Fonts->AddFontDefault(&font);
    io.FontGlobalScale = float(1 / density);
    ImGui::StyleColorsDark();
    ImGuiStyle& style = ImGui::GetStyle();
    style.WindowRounding = 4;
    style.ScaleAllSizes(float(size.contentScale / density));
    ImGui_ImplOpenGL3_Init("#version 450 core");
}

ViewPanel::~ViewPanel() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui::DestroyContext();
}

bool ViewPanel::handle(const ViewEvent& event) {
    ImGuiIO& io = ImGui::GetIO();
    io.KeyShift =
        event.kind == ViewEventKind::Key || event.kind == ViewEventKind::Button ? event.shift : io.KeyShift;
    switch (event.kind) {
        case ViewEventKind::Cursor:
            io.MousePos = ImVec2(float(event.x), float(event.y));
            return false;
        case ViewEventKind::Button:
            io.MouseDown[int(event.button)] = event.pressed;
            return event.pressed && io.WantCaptureMouse;
        case ViewEventKind::Scroll:
            io.MouseWheelH += float(event.x);
            io.MouseWheel += float(event.y);
            return io.WantCaptureMouse;
        case ViewEventKind::Key:
            io.KeyCtrl = event.control;
            if (event.key == Key::Unknown) return true;
            io.KeysDown[int(event.key)] = event.pressed;
            return event.pressed && io.WantTextInput;
        case ViewEventKind::Text:
            io.AddInputCharacter(event.character);
            return true;
        case ViewEventKind::Leave:
            std::ranges::fill(io.MouseDown, false);
            std::ranges::fill(io.KeysDown, false);
            return false;
        default:
            return false;
    }
}

void ViewPanel::update(double seconds, const WindowSize& size, const SceneView& scene, const ViewInput& input,
                       const PanelFacts& facts, ViewState& state, ViewRequests& requests) {
    ImGuiIO& io = ImGui::GetIO();
    io.DisplaySize = ImVec2(float(size.width), float(size.height));
    io.DisplayFramebufferScale =
        ImVec2(float(size.pixelWidth) / float(size.width), float(size.pixelHeight) / float(size.height));
    io.DeltaTime = float(std::max(seconds, 1e-4));
    ImGui_ImplOpenGL3_NewFrame();
    ImGui::NewFrame();
    visible_ = state.panel || state.help;
    if (state.panel && !state.help) {
        const float scale = ImGui::GetFontSize() / kFontPixels;
        ImGui::SetNextWindowPos(ImVec2(float(size.width) - kMargin, kMargin), ImGuiCond_Always, ImVec2(1, 0));
        ImGui::SetNextWindowSizeConstraints(ImVec2(kPanelWidth * scale, 0),
                                            ImVec2(kPanelWidth * scale, float(size.height) - 2 * kMargin));
        ImGui::SetNextWindowBgAlpha(0.88f);
        ImGui::Begin(facts.bundle.c_str(), nullptr,
                     ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove);
        ImGui::PushItemWidth(ImGui::GetWindowContentRegionWidth() * 0.62f);
        const ViewChoices& choices = scene.choices();
        techniqueSection(choices, state);
        if (ImGui::CollapsingHeader("light", ImGuiTreeNodeFlags_DefaultOpen)) lightSection(choices, state);
        if (ImGui::CollapsingHeader("picture", ImGuiTreeNodeFlags_DefaultOpen))
            pictureSection(scene.statistics(), state);
        if (ImGui::CollapsingHeader("statistics", ImGuiTreeNodeFlags_DefaultOpen))
            statisticsSection(scene, facts);
        ImGui::Separator();
        if (ImGui::Button("fit")) input.act(ViewAction::Fit, state, requests);
        ImGui::SameLine();
        if (ImGui::Button("reset")) input.act(ViewAction::Reset, state, requests);
        ImGui::SameLine();
        if (ImGui::Button("screenshot")) input.act(ViewAction::Screenshot, state, requests);
        ImGui::SameLine();
        if (ImGui::Button("help")) input.act(ViewAction::Help, state, requests);
        if (!scene.statistics().problem.empty()) {
            ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(1, 0.6f, 0.4f, 1));
            ImGui::TextWrapped("%s", scene.statistics().problem.c_str());
            ImGui::PopStyleColor();
        }
        if (!facts.message.empty()) ImGui::TextWrapped("%s", facts.message.c_str());
        ImGui::PopItemWidth();
        ImGui::End();
        if (const PointColours* colours = scene.pointColours()) legendWindow(*colours, size);
    }
    if (state.help) helpWindow(size, state);
    ImGui::Render();
}

void ViewPanel::draw() {
    if (visible_) ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

}  // namespace prt::tools
