#include "tools/report.h"

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "precompute/base/atomic_file.h"
#include "precompute/base/error.h"

namespace prt::tools {

struct Report::State {
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
};

Report::Report() : state_(std::make_unique<State>()) {}
Report::~Report() = default;
Report::Report(Report&&) noexcept = default;
Report& Report::operator=(Report&&) noexcept = default;

Report& Report::set(const std::string& key, double value) {
    // JSON has no infinity: an error of exactly zero gives a PSNR that is null.
    if (std::isfinite(value))
        state_->json[key] = value;
    else
        state_->json[key] = nullptr;
    return *this;
}
Report& Report::set(const std::string& key, uint64_t value) {
    state_->json[key] = value;
    return *this;
}
Report& Report::set(const std::string& key, bool value) {
    state_->json[key] = value;
    return *this;
}
Report& Report::set(const std::string& key, const std::string& value) {
    state_->json[key] = value;
    return *this;
}
Report& Report::set(const std::string& key, const Report& object) {
    state_->json[key] = object.state_->json;
    return *this;
}
Report& Report::set(const std::string& key, const std::vector<Report>& rows) {
    auto array = nlohmann::ordered_json::array();
    for (const Report& row : rows) array.push_back(row.state_->json);
    state_->json[key] = std::move(array);
    return *this;
}
Report& Report::setJson(const std::string& key, const std::string& json) {
    state_->json[key] = nlohmann::ordered_json::parse(json);
    return *this;
}

std::string Report::text() const {
    return state_->json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

void Report::write(const std::string& file) const {
    if (file.empty()) return;
    if (file != "-") {
        writeFileAtomically(file, text());
        return;
    }
    const std::string all = text();
    if (std::fwrite(all.data(), 1, all.size(), stdout) != all.size() || std::fflush(stdout) != 0)
        throw OutputError("standard output", "cannot be written");
}

}  // namespace prt::tools
