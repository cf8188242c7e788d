// Errors that a user can cause, and what the command line does with them.
#pragma once

#include <stdexcept>
#include <string>

namespace prt {

/// Base of every error that is not a bug: what() is one line, `where: problem; remedy`.
class Error : public std::runtime_error {
  public:
    /// @param where    file, file:line, option or object the problem is in
    /// @param problem  what is wrong, with the numbers that show it
    /// @param remedy   what to do about it; may be empty
    Error(std::string where, std::string problem, std::string remedy = {});
    const std::string& where() const { return where_; }
    const std::string& problem() const { return problem_; }
    const std::string& remedy() const { return remedy_; }

  private:
    std::string where_, problem_, remedy_;
};

/// An option or argument out of range or contradicting another (exit code 2).
class UsageError : public Error {
  public:
    using Error::Error;
};

/// A file or a value that cannot be used (exit code 3).
class InputError : public Error {
  public:
    using Error::Error;
};

/// A file that cannot be written (exit code 4).
class OutputError : public Error {
  public:
    using Error::Error;
};

/// Thrown by long work after requestInterrupt() (exit code 130).
class Interrupted : public std::exception {
  public:
    const char* what() const noexcept override { return "interrupted"; }
};

/// Asks running work to stop at its next check. Async-signal-safe.
void requestInterrupt() noexcept;
/// Forgets an earlier request (tests).
void clearInterrupt() noexcept;
bool interruptRequested() noexcept;
/// @throws Interrupted if an interrupt was requested
void throwIfInterrupted();

}  // namespace prt
