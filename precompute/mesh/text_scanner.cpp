// Number syntax: std::from_chars, which knows no locale.
#include "precompute/mesh/text_scanner.h"

#include <fmt/format.h>

#include <charconv>
#include <limits>

#include "precompute/base/error.h"

namespace prt {
namespace {
bool isSpace(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f'; }
/// Words of damaged files may hold anything: shown short, and printable.
std::string shown(std::string_view word) {
    std::string result;
    for (char c : word.substr(0, 24)) result += c >= 32 && c < 127 ? c : '?';
    return result;
}
}  // namespace

std::optional<double> parseNumber(std::string_view word) {
    if (!word.empty() && word[0] == '+') word.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (end != word.data() + word.size() || error == std::errc::invalid_argument) return std::nullopt;
    if (error == std::errc::result_out_of_range) {
        const bool small = word.find("e-") != word.npos || word.find("E-") != word.npos;
        return small ? 0.0 : std::numeric_limits<double>::infinity();
    }
    return value;
}

std::optional<long long> parseInteger(std::string_view word) {
    if (!word.empty() && word[0] == '+') word.remove_prefix(1);
    long long value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (end != word.data() + word.size() || error != std::errc()) return std::nullopt;
    return value;
}

void TextScanner::skipSpace() {
    while (at_ < text_.size() && isSpace(text_[at_])) line_ += text_[at_++] == '\n';
}

bool TextScanner::atEnd() {
    skipSpace();
    return at_ == text_.size();
}

std::string_view TextScanner::word() {
    skipSpace();
    const size_t begin = at_;
    while (at_ < text_.size() && !isSpace(text_[at_])) ++at_;
    return text_.substr(begin, at_ - begin);
}

std::string_view TextScanner::restOfLine() {
    const size_t end = std::min(text_.find('\n', at_), text_.size());
    std::string_view line = text_.substr(at_, end - at_);
    at_ = std::min(end + 1, text_.size());
    line_ += end < text_.size();
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return line;
}

std::string_view TextScanner::contentLine() {
    while (!atEnd()) {
        const size_t lineBefore = line_;
        std::string_view line = restOfLine();
        line = line.substr(0, line.find('#'));
        std::string_view probe = line;
        if (takeWord(probe).empty()) continue;
        line_ = lineBefore;  // messages about this line are to name it; the next read moves on
        at_ = size_t(line.data() + line.size() - text_.data());
        const size_t end = text_.find('\n', at_);
        at_ = end == text_.npos ? text_.size() : end;
        return line;
    }
    return {};
}

double TextScanner::number(std::string_view what) {
    const std::string_view next = word();
    if (next.empty()) fail(fmt::format("the file ends where {} should stand", what));
    if (const auto value = parseNumber(next)) return *value;
    fail(fmt::format("'{}' stands where {} should", shown(next), what));
}

long long TextScanner::integer(std::string_view what) {
    const std::string_view next = word();
    if (next.empty()) fail(fmt::format("the file ends where {} should stand", what));
    if (const auto value = parseInteger(next)) return *value;
    fail(fmt::format("'{}' stands where {} should", shown(next), what));
}

std::string TextScanner::here() const { return fmt::format("{}:{}", where_, line_); }

void TextScanner::fail(const std::string& problem) const {
    throw InputError(here(), problem, "re-export the mesh");
}

std::string_view takeWord(std::string_view& line) {
    size_t begin = 0;
    while (begin < line.size() && isSpace(line[begin])) ++begin;
    size_t end = begin;
    while (end < line.size() && !isSpace(line[end])) ++end;
    const std::string_view result = line.substr(begin, end - begin);
    line.remove_prefix(end);
    return result;
}

}  // namespace prt
