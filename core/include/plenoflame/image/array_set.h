#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

/// Arrays in an HDF5 file on disk, so that the arrays of many pictures need not be in memory
/// together. HDF5 is used by one thread at a time.
namespace plenoflame {

class ArraySetWriter {
 public:
  /// @throws FileError naming the file
  explicit ArraySetWriter(const std::string& path);
  ~ArraySetWriter();
  ArraySetWriter(const ArraySetWriter&) = delete;
  ArraySetWriter& operator=(const ArraySetWriter&) = delete;

  /// Makes an array of `rows` arrays of this shape in 32-bit numbers, to be filled by put(). Each
  /// row is a chunk, or each first index of a large row; chunks are compressed without loss
  /// (deflate). Makes the groups above it. @param axes names of all axes, "run,row,column"
  void rows(const std::string& path, std::size_t rows, std::vector<std::size_t> shape,
            const std::string& unit, const std::string& axes);
  /// Writes a row of it. Rows that are never written are 0.
  void put(const std::string& path, std::size_t row, std::span<const float> values);
  /// Single arrays. With an empty shape they are lists.
  void numbers(const std::string& path, std::span<const double> values, const std::string& unit,
               std::vector<std::size_t> shape = {});
  void whole_numbers(const std::string& path, std::span<const std::int64_t> values);
  void texts(const std::string& path, const std::vector<std::string>& values);
  /// A text that belongs to an array, to a group or ("/") to the file.
  void attribute(const std::string& path, const std::string& name, const std::string& text);
  void attribute(const std::string& path, const std::string& name, std::span<const double> values);
  /// Finishes the file. @throws FileError: disk full
  void close();

 private:
  [[noreturn]] void fail(const std::string& what) const;
  void check(std::int64_t status, const char* what) const;
  void make(const std::string& path, std::int64_t type, std::int64_t memory_type,
            const std::vector<std::size_t>& shape, const void* values);

  std::string path_;
  std::int64_t file_ = -1;
};

struct StoredArray {
  std::vector<std::size_t> shape;
  std::vector<float> values;
};

/// Reads an array of such a file, as 32-bit numbers. @throws FileError
StoredArray read_stored_array(const std::string& file, const std::string& path);

}  // namespace plenoflame
