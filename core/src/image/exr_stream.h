#pragma once
#include <OpenEXR/ImfIO.h>

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>

#include "plenoflame/image/atomic_file.h"

namespace plenoflame {

/// OpenEXR's output on an AtomicFile. Unlike OpenEXR's own stream it remembers failures that
/// OpenEXR swallows (its destructors do), and knows their cause.
class ExrOutput : public Imf::OStream {
 public:
  explicit ExrOutput(AtomicFile& file, const std::string& name)
      : Imf::OStream(name.c_str()), file_(file) {}
  void write(const char c[], int n) override;
  std::uint64_t tellp() override { return static_cast<std::uint64_t>(ftello(file_.stream())); }
  void seekp(std::uint64_t position) override;
  /// errno of the first failure; 0: none.
  int error() const { return error_; }

 private:
  AtomicFile& file_;
  int error_ = 0;
};

/// OpenEXR's input on a file; knows the file's size.
class ExrInput : public Imf::IStream {
 public:
  /// @throws FileError
  explicit ExrInput(const std::string& path);
  bool read(char c[], int n) override;
  std::uint64_t tellg() override { return static_cast<std::uint64_t>(ftello(file_.get())); }
  void seekg(std::uint64_t position) override;
  void clear() override { std::clearerr(file_.get()); }
  std::uint64_t size() const { return size_; }

  /// Checks from the start of the file that this is a scan-line EXR whose header's attributes fit
  /// into the file. OpenEXR would otherwise allocate the size that a damaged length states.
  /// Rewinds.
  /// @throws FileError (not an EXR, damaged), InputError (tiled, deep or multi-part)
  void check_header();

 private:
  std::string read_name();

  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::string path_;
  std::unique_ptr<std::FILE, Closer> file_;
  std::uint64_t size_ = 0;
};

}  // namespace plenoflame
