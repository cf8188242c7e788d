// Words and numbers of a text file, with line numbers for messages. Internal to the mesh stage.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace prt {

/// A number as C prints it, "nan" and "inf" included; what overflows is infinite, what underflows 0.
std::optional<double> parseNumber(std::string_view word);
std::optional<long long> parseInteger(std::string_view word);

class TextScanner {
  public:
    TextScanner(std::string_view text, std::string where) : text_(text), where_(std::move(where)) {}

    /// Next word, over line ends; empty at the end of the file.
    std::string_view word();
    /// Rest of the current line without its end; moves to the next line.
    std::string_view restOfLine();
    /// Next line that has anything but white space and a comment from '#' on; empty at the end of the file.
    std::string_view contentLine();
    /// @throws InputError  not a number; the text ends (`what` names the thing that is missing)
    double number(std::string_view what);
    long long integer(std::string_view what);
    bool atEnd();
    size_t position() const { return at_; }
    size_t line() const { return line_; }
    /// "file:line"
    std::string here() const;
    [[noreturn]] void fail(const std::string& problem) const;

  private:
    void skipSpace();

    std::string_view text_;
    std::string where_;
    size_t at_ = 0, line_ = 1;
};

/// First word of a line; the line is shortened by it.
std::string_view takeWord(std::string_view& line);

}  // namespace prt
