// Machine-readable results: keys in the order they were set, rows as arrays of objects. JSON lives in
// report.cpp only.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace prt::tools {

class Report {
  public:
    Report();
    ~Report();
    Report(Report&&) noexcept;
    Report& operator=(Report&&) noexcept;

    Report& set(const std::string& key, double value);
    Report& set(const std::string& key, uint64_t value);
    Report& set(const std::string& key, int value) { return set(key, uint64_t(value)); }
    Report& set(const std::string& key, bool value);
    Report& set(const std::string& key, const std::string& value);
    Report& set(const std::string& key, const char* value) { return set(key, std::string(value)); }
    Report& set(const std::string& key, const Report& object);
    Report& set(const std::string& key, const std::vector<Report>& rows);
    /// @param json  text of a JSON value
    Report& setJson(const std::string& key, const std::string& json);

    std::string text() const;
    /// Writes to `file`, to standard output for "-", nowhere for "".
    /// @throws OutputError
    void write(const std::string& file) const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace prt::tools
