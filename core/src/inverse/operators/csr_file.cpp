#include <fmt/format.h>
#include <hdf5.h>
#include <zlib.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <string_view>

#include "base/fnv.h"
#include "lightfield/export/array_files.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/inverse/csr_matrix.h"

namespace plenoflame {
namespace {

/// The parts of a matrix as files hold them.
struct Parts {
  std::vector<std::int64_t> shape, starts, columns, part;
  std::vector<double> values;
};

[[noreturn]] void refuse(const std::string& path, const std::string& reason) {
  throw FileError(path + ": " + reason);
}

CsrPart part_of(const std::string& path, const std::vector<std::int64_t>& numbers) {
  if (numbers.empty()) return {};
  if (numbers.size() != 3 || numbers[0] < 1 || numbers[0] > numbers[1] || numbers[1] > kMostParts)
    refuse(path, "the array \"part\" is damaged");
  return {{static_cast<int>(numbers[0]), static_cast<int>(numbers[1])}, numbers[2]};
}

CsrMatrix<float> matrix_of(const std::string& path, Parts parts) {
  if (parts.shape.size() != 2 || parts.shape[0] < 0 || parts.shape[1] < 0)
    refuse(path, "the matrix has no shape of rows and columns");
  if (parts.starts.size() != static_cast<std::size_t>(parts.shape[0]) + 1)
    refuse(path,
           fmt::format("indptr has {} entries for {} rows", parts.starts.size(), parts.shape[0]));
  std::vector<std::int32_t> columns;
  columns.reserve(parts.columns.size());
  for (const std::int64_t column : parts.columns) {
    if (column < 0 || column >= parts.shape[1])
      refuse(path, fmt::format("the matrix has column {} of {}", column, parts.shape[1]));
    columns.push_back(static_cast<std::int32_t>(column));
  }
  try {
    return CsrMatrix<float>(static_cast<std::size_t>(parts.shape[1]), std::move(parts.starts),
                            std::move(columns),
                            std::vector<float>(parts.values.begin(), parts.values.end()));
  } catch (const InputError& error) {
    refuse(path, error.what());
  }
}

// ---- numpy's .npz -------------------------------------------------------------------------------

std::uint64_t little_endian(std::string_view bytes, std::size_t at, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < count; ++i)
    value |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[at + i])) << (8 * i);
  return value;
}

/// Files of a ZIP archive (PKWARE APPNOTE 6.3.10), stored or deflated, without 64-bit records.
class ZipArchive {
 public:
  ZipArchive(const std::string& path, std::string_view bytes) : path_(path), bytes_(bytes) {
    constexpr std::size_t kEndRecord = 22, kRecord = 46;
    const std::size_t end = bytes.rfind(std::string_view("PK\5\6", 4));
    if (end == std::string_view::npos || end + kEndRecord > bytes.size())
      refuse(path, "this is no .npz file, or it is cut off");
    std::size_t at = little_endian(bytes, end + 16, 4);
    for (std::uint64_t left = little_endian(bytes, end + 10, 2); left > 0; --left) {
      if (at + kRecord > end || bytes.substr(at, 4) != std::string_view("PK\1\2", 4))
        refuse(path, "the directory of this .npz file is damaged");
      const std::size_t name = little_endian(bytes, at + 28, 2);
      if (at + kRecord + name > end) refuse(path, "the directory of this .npz file is damaged");
      entries_[std::string(bytes.substr(at + kRecord, name))] = {
          little_endian(bytes, at + 10, 2), little_endian(bytes, at + 20, 4),
          little_endian(bytes, at + 24, 4), little_endian(bytes, at + 42, 4)};
      at += kRecord + name + little_endian(bytes, at + 30, 2) + little_endian(bytes, at + 32, 2);
    }
  }

  bool has(const std::string& name) const { return entries_.contains(name); }
  std::string file(const std::string& name) const {
    const auto found = entries_.find(name);
    if (found == entries_.end()) refuse(path_, "there is no array \"" + name + "\" in it");
    const Entry& entry = found->second;
    constexpr std::size_t kLocal = 30;
    if (entry.offset + kLocal > bytes_.size()) refuse(path_, "it is cut off");
    const std::size_t begin = entry.offset + kLocal + little_endian(bytes_, entry.offset + 26, 2) +
                              little_endian(bytes_, entry.offset + 28, 2);
    if (begin > bytes_.size() || entry.packed > bytes_.size() - begin)
      refuse(path_, "it is cut off");
    const std::string_view packed = bytes_.substr(begin, entry.packed);
    if (entry.method == 0) return std::string(packed);
    // Deflate makes nothing more than 1032 times smaller: what claims more is not believed.
    if (entry.method != 8 || entry.size / 1040 > entry.packed)
      refuse(path_, "the array \"" + name + "\" is packed in a way that is not known");
    return inflated(packed, entry.size, name);
  }

 private:
  struct Entry {
    std::uint64_t method, packed, size, offset;
  };

  std::string inflated(std::string_view packed, std::size_t size, const std::string& name) const {
    std::string result(size, '\0');
    z_stream stream{};
    if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) throw FileError("zlib cannot begin");
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
    stream.avail_in = static_cast<uInt>(packed.size());
    stream.next_out = reinterpret_cast<Bytef*>(result.data());
    stream.avail_out = static_cast<uInt>(result.size());
    const int status = inflate(&stream, Z_FINISH);
    inflateEnd(&stream);
    if (status != Z_STREAM_END || stream.avail_out != 0)
      refuse(path_, "the array \"" + name + "\" is damaged");
    return result;
  }

  std::string path_;
  std::string_view bytes_;
  std::map<std::string, Entry> entries_;
};

/// The data of a .npy file of one of four kinds, as Number.
template <class Number>
std::vector<Number> npy_values(const std::string& path, const std::string& bytes) {
  const std::string_view all(bytes);
  if (all.size() < 12 || all.substr(0, 6) != "\x93NUMPY") refuse(path, "an array is damaged");
  const bool long_header = all[6] > 1;
  const std::size_t start = long_header ? 12 : 10;
  const std::size_t length = little_endian(all, 8, long_header ? 4 : 2);
  if (length > all.size() - start) refuse(path, "an array is cut off");
  const std::string_view header = all.substr(start, length);
  if (header.find("'fortran_order': True") != std::string_view::npos)
    refuse(path, "an array has the order of Fortran");
  const std::string_view data = all.substr(start + length);
  const auto converted = [&]<class Stored>(Stored) {
    if (data.size() % sizeof(Stored) != 0) refuse(path, "an array is cut off");
    std::vector<Stored> stored(data.size() / sizeof(Stored));
    std::memcpy(stored.data(), data.data(), data.size());
    return std::vector<Number>(stored.begin(), stored.end());
  };
  if (header.find("'<f4'") != std::string_view::npos) return converted(float{});
  if (header.find("'<f8'") != std::string_view::npos) return converted(double{});
  if (header.find("'<i4'") != std::string_view::npos) return converted(std::int32_t{});
  if (header.find("'<i8'") != std::string_view::npos) return converted(std::int64_t{});
  refuse(path, "an array is of a type other than 32 or 64-bit numbers");
}

Parts read_npz(const std::string& path) {
  const std::string bytes = read_file(path);
  const ZipArchive archive(path, bytes);
  const std::string format = archive.file("format.npy");
  if (!format.ends_with("csr"))
    refuse(path, "this sparse matrix is not in compressed rows: write it with .tocsr()");
  Parts parts;
  parts.shape = npy_values<std::int64_t>(path, archive.file("shape.npy"));
  parts.starts = npy_values<std::int64_t>(path, archive.file("indptr.npy"));
  parts.columns = npy_values<std::int64_t>(path, archive.file("indices.npy"));
  parts.values = npy_values<double>(path, archive.file("data.npy"));
  if (archive.has("part.npy"))
    parts.part = npy_values<std::int64_t>(path, archive.file("part.npy"));
  return parts;
}

// ---- HDF5 ---------------------------------------------------------------------------------------

/// Largest number of values per stored byte: deflate shrinks by a factor of 1032 at most.
constexpr hsize_t kMostShrunk = 1040;

template <class Number>
std::vector<Number> hdf5_values(const std::string& path, hid_t file, hsize_t file_size,
                                const char* name, hid_t type) {
  if (H5Lexists(file, name, H5P_DEFAULT) <= 0)
    refuse(path, fmt::format("there is no dataset \"{}\" in it", name));
  const hid_t data = H5Dopen2(file, name, H5P_DEFAULT);
  if (data < 0) refuse(path, fmt::format("\"{}\" is no dataset", name));
  const hid_t space = H5Dget_space(data);
  const hssize_t count = H5Sget_simple_extent_npoints(space);
  // A size beyond what the storage can hold, packed at deflate's best, is not believed.
  const hsize_t stored = H5Dget_storage_size(data);
  const hid_t made = H5Dget_create_plist(data), item = H5Dget_type(data);
  const hsize_t most = (H5Pget_layout(made) == H5D_CHUNKED ? kMostShrunk : 1) * stored;
  const bool believable =
      count >= 0 && stored <= file_size &&
      static_cast<hsize_t>(count) <= most / std::max<hsize_t>(1, H5Tget_size(item));
  H5Tclose(item);
  H5Pclose(made);
  std::vector<Number> values;
  herr_t status = -1;
  if (believable) {
    values.resize(static_cast<std::size_t>(count));
    status = H5Dread(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  }
  H5Sclose(space);
  H5Dclose(data);
  if (status < 0) refuse(path, fmt::format("the dataset \"{}\" cannot be read", name));
  return values;
}

Parts read_hdf5(const std::string& path) {
  const hsize_t size = read_file(path).size();  // says what is wrong with one that cannot be read
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (file < 0) refuse(path, "this is no HDF5 file, or it is damaged");
  struct Closer {
    hid_t file;
    ~Closer() { H5Fclose(file); }
  } const closer{file};
  Parts parts;
  parts.shape = hdf5_values<std::int64_t>(path, file, size, "shape", H5T_NATIVE_INT64);
  parts.starts = hdf5_values<std::int64_t>(path, file, size, "indptr", H5T_NATIVE_INT64);
  parts.columns = hdf5_values<std::int64_t>(path, file, size, "indices", H5T_NATIVE_INT64);
  parts.values = hdf5_values<double>(path, file, size, "data", H5T_NATIVE_DOUBLE);
  if (H5Lexists(file, "part", H5P_DEFAULT) > 0)
    parts.part = hdf5_values<std::int64_t>(path, file, size, "part", H5T_NATIVE_INT64);
  return parts;
}

// ---- MatrixMarket -------------------------------------------------------------------------------

std::string matrix_market(const CsrMatrix<float>& matrix) {
  std::string text = "%%MatrixMarket matrix coordinate real general\n";
  text += fmt::format("{} {} {}\n", matrix.rows(), matrix.columns(), matrix.entries());
  for (std::size_t row = 0; row < matrix.rows(); ++row)
    for (auto k = static_cast<std::size_t>(matrix.row_starts()[row]);
         k < static_cast<std::size_t>(matrix.row_starts()[row + 1]); ++k)
      text +=
          fmt::format("{} {} {}\n", row + 1, matrix.column_indices()[k] + 1, matrix.values()[k]);
  return text;
}

Parts read_matrix_market(const std::string& path) {
  const std::string text = read_file(path);
  std::size_t line = 0, at = 0;
  const auto next_line = [&]() -> std::optional<std::string_view> {
    while (at < text.size()) {
      const std::size_t end = std::min(text.find('\n', at), text.size());
      const std::string_view found = std::string_view(text).substr(at, end - at);
      at = end + 1;
      ++line;
      if (line == 1 || (!found.empty() && found[0] != '%' &&
                        found.find_first_not_of(" \t\r") != std::string_view::npos))
        return found;
    }
    return std::nullopt;
  };
  const auto numbers = [&](std::string_view words, auto&... each) {
    const char* p = words.data();
    const char* const end = p + words.size();
    const auto read = [&](auto& number) {
      while (p < end && (*p == ' ' || *p == '\t')) ++p;
      const auto result = std::from_chars(p, end, number);
      p = result.ptr;
      return result.ec == std::errc();
    };
    if (!(read(each) && ...))
      refuse(fmt::format("{}:{}", path, line), "this line does not have its three numbers");
  };
  const auto head = next_line();
  if (!head || !head->starts_with("%%MatrixMarket matrix coordinate real general"))
    refuse(path, "the first line is not \"%%MatrixMarket matrix coordinate real general\"");
  const auto sizes = next_line();
  if (!sizes) refuse(path, "the line with the size of the matrix is missing");
  std::int64_t rows = 0, columns = 0, count = 0;
  numbers(*sizes, rows, columns, count);
  // An entry takes at least six characters, a row that has none takes nothing.
  if (rows < 0 || columns < 0 || count < 0 || count > static_cast<std::int64_t>(text.size()) / 6 ||
      rows > (std::int64_t{1} << 40))
    refuse(fmt::format("{}:{}", path, line), "this size does not fit the file");
  struct Entry {
    std::int64_t row, column;
    double value;
  };
  std::vector<Entry> entries;
  entries.reserve(static_cast<std::size_t>(count));
  while (const auto words = next_line()) {
    Entry entry{};
    numbers(*words, entry.row, entry.column, entry.value);
    if (entry.row < 1 || entry.row > rows || entry.column < 1 || entry.column > columns)
      refuse(fmt::format("{}:{}", path, line), "this entry lies outside of the matrix");
    entries.push_back(entry);
  }
  if (static_cast<std::int64_t>(entries.size()) != count)
    refuse(path, fmt::format("there are {} entries, {} are announced", entries.size(), count));
  std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return a.row != b.row ? a.row < b.row : a.column < b.column;
  });
  Parts parts;
  parts.shape = {rows, columns};
  parts.starts.reserve(static_cast<std::size_t>(rows) + 1);
  parts.starts.push_back(0);
  for (const Entry& entry : entries) {
    while (static_cast<std::int64_t>(parts.starts.size()) < entry.row)
      parts.starts.push_back(static_cast<std::int64_t>(parts.columns.size()));
    parts.columns.push_back(entry.column - 1);
    parts.values.push_back(entry.value);
  }
  parts.starts.resize(static_cast<std::size_t>(rows) + 1, count);
  return parts;
}

}  // namespace

std::int64_t csr_work(const std::string& description) {
  Fnv sum;
  sum.add(description);
  return static_cast<std::int64_t>(sum.value());
}

void write_csr(const std::string& path, const CsrMatrix<float>& matrix, const CsrPart& part) {
  if (!std::all_of(matrix.values().begin(), matrix.values().end(),
                   [](float value) { return std::isfinite(value); }))
    throw InputError(path +
                     ": is not written: an entry of the matrix is no finite number; a value of the "
                     "scene or of the options is far out of range");
  if (path.ends_with(".mtx")) {
    if (!part.part.is_whole())
      throw UsageError(path + ": parts of a matrix are written as .npz or .h5");
    write_file(path, matrix_market(matrix));
    return;
  }
  const std::size_t entries = matrix.entries();
  std::vector<NamedArray> arrays{
      {"indices",
       "",
       "",
       {entries},
       std::vector<std::int32_t>(matrix.column_indices().begin(), matrix.column_indices().end())},
      {"indptr",
       "",
       "",
       {matrix.rows() + 1},
       std::vector<std::int64_t>(matrix.row_starts().begin(), matrix.row_starts().end())},
      {"shape",
       "",
       "",
       {2},
       std::vector<std::int64_t>{static_cast<std::int64_t>(matrix.rows()),
                                 static_cast<std::int64_t>(matrix.columns())}},
      {"data",
       "",
       "",
       {entries},
       std::vector<float>(matrix.values().begin(), matrix.values().end())}};
  if (!part.part.is_whole())
    arrays.push_back({"part",
                      "",
                      "",
                      {3},
                      std::vector<std::int64_t>{part.part.number, part.part.count, part.work}});
  if (path.ends_with(".npz")) {
    write_file(path, npz_bytes(arrays, {{"format", "csr"}}));
  } else if (path.ends_with(".h5")) {
    Hdf5File file;
    for (const NamedArray& array : arrays) file.dataset(array.name, array);
    write_file(path, file.bytes());
  } else {
    throw UsageError(path + ": sparse matrices are written as .npz, .h5 or .mtx");
  }
}

CsrMatrix<float> read_csr(const std::string& path, CsrPart* part) {
  const auto read = [&] {
    if (path.ends_with(".npz")) return read_npz(path);
    if (path.ends_with(".h5")) return read_hdf5(path);
    if (path.ends_with(".mtx")) return read_matrix_market(path);
    throw UsageError(path + ": sparse matrices are read from .npz, .h5 or .mtx");
  };
  Parts parts = read();
  if (part) *part = part_of(path, parts.part);
  return matrix_of(path, std::move(parts));
}

CsrMatrix<float> merge_csr(const std::vector<std::string>& paths) {
  std::map<int, std::pair<std::string, CsrMatrix<float>>> parts;
  CsrPart first;
  std::size_t columns = 0;
  for (const std::string& path : paths) {
    CsrPart own;
    CsrMatrix<float> matrix = read_csr(path, &own);
    if (own.part.is_whole()) throw InputError(path + ": is no part of a matrix: it is whole");
    if (parts.empty()) first = own, columns = matrix.columns();
    if (own.part.count != first.part.count || own.work != first.work || matrix.columns() != columns)
      throw InputError(fmt::format(
          "{}: belongs to another matrix than {}: the scene, the settings, the number of "
          "parts or the version of Plenoflame differ; make all parts by one version",
          path, paths.front()));
    const auto [at, is_new] = parts.try_emplace(own.part.number, path, std::move(matrix));
    if (!is_new)
      throw InputError(fmt::format("{} and {} are the same part, {}", at->second.first, path,
                                   to_string(own.part)));
  }
  std::vector<std::int64_t> starts{0};
  std::vector<std::int32_t> indices;
  std::vector<float> values;
  for (int number = 1; number <= first.part.count; ++number) {
    const auto found = parts.find(number);
    if (found == parts.end())
      throw InputError(fmt::format("part {} is missing", to_string({number, first.part.count})));
    const CsrMatrix<float>& matrix = found->second.second;
    for (const std::int64_t start : matrix.row_starts().subspan(1))
      starts.push_back(static_cast<std::int64_t>(values.size()) + start);
    indices.insert(indices.end(), matrix.column_indices().begin(), matrix.column_indices().end());
    values.insert(values.end(), matrix.values().begin(), matrix.values().end());
    found->second.second = {};
  }
  return CsrMatrix<float>(columns, std::move(starts), std::move(indices), std::move(values));
}

}  // namespace plenoflame
