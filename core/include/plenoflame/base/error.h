#pragma once
#include <stdexcept>
#include <string>

namespace plenoflame {

/// A place in a text file. Line and column count from 1; 0 means unknown.
struct SourcePosition {
  std::string file;
  int line = 0;
  int column = 0;
};

/// "file:line:column", leaving out what is unknown; empty when nothing is known.
std::string to_string(const SourcePosition& position);

/// Base of everything that Plenoflame throws. what() is one line that says what to do about it.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A scene, flame or other input is wrong. The command line ends with status 1.
class InputError : public Error {
 public:
  explicit InputError(const std::string& message) : Error(message) {}
  /// Message with "file:line:column: " in front.
  InputError(const SourcePosition& position, const std::string& message);
  const SourcePosition& position() const { return position_; }

 private:
  SourcePosition position_;
};

/// A file cannot be opened, read, written or renamed. Status 1.
class FileError : public Error {
 public:
  using Error::Error;
};

/// The command line or an option value is wrong. Status 2.
class UsageError : public Error {
 public:
  using Error::Error;
};

/// Work was stopped through Execution::stop before there was a result.
class Cancelled : public Error {
 public:
  Cancelled() : Error("stopped before there was a result") {}
};

}  // namespace plenoflame
