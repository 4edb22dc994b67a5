#include "plenoflame/film/checkpoint.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <utility>
#include <vector>

#include "base/fnv.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"

namespace plenoflame {
namespace {

constexpr std::string_view kMagic = "plenoflame film 7\n";

template <class T>
std::string_view bytes_of(const T* data, std::size_t count) {
  return {reinterpret_cast<const char*>(data), count * sizeof(T)};
}

class Reader {
 public:
  Reader(const std::string& path, std::string_view text) : path_(path), rest_(text) {}
  std::string_view take(std::size_t count) {
    if (count > rest_.size())
      throw FileError(path_ + ": is damaged (too short); start the run again without it");
    const std::string_view part = rest_.substr(0, count);
    rest_.remove_prefix(count);
    return part;
  }
  template <class T>
  T number() {
    T value;
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }
  std::size_t left() const { return rest_.size(); }

 private:
  const std::string& path_;
  std::string_view rest_;
};

/// The states of a tile.
constexpr char kNothing = 0, kSums = 1;

/// Calls `take` with the bytes of each tile that holds anything.
template <class Take>
void for_tiles(const Film& film, const Take& take) {
  for (int tile = 0; tile < film.tile_count(); ++tile)
    if (const std::vector<double>& sums = film.tile_sums(tile); !sums.empty())
      take(bytes_of(sums.data(), sums.size()));
}

void write_film(const Film& film, AtomicFile& file) {
  const PixelWindow& w = film.window();
  const std::array<std::int32_t, 6> shape{
      w.x, w.y, w.width, w.height, film.channels(), film.replicates()};
  const std::string_view tiles =
      bytes_of(film.all_tile_samples().data(), film.all_tile_samples().size());
  // The tiles' states come first: only tiles with anything in them follow.
  std::string present;
  for (int tile = 0; tile < film.tile_count(); ++tile)
    present += film.tile_sums(tile).empty() ? kNothing : kSums;
  const std::uint64_t goal_count = film.tile_goals().size();
  const std::string_view goals = bytes_of(film.tile_goals().data(), film.tile_goals().size());
  Fnv sum;
  sum.add(bytes_of(shape.data(), shape.size()));
  for (const std::string_view part : {std::string_view(tiles), goals, std::string_view(present)})
    sum.add(part);
  for_tiles(film, [&](std::string_view bytes) { sum.add(bytes); });
  file.write(bytes_of(shape.data(), shape.size()));
  const std::uint64_t checksum = sum.value();
  file.write(bytes_of(&checksum, 1));
  file.write(tiles);
  file.write(bytes_of(&goal_count, 1));
  file.write(goals);
  file.write(present);
  for_tiles(film, [&](std::string_view bytes) { file.write(bytes); });
}

FileError damaged_state(const std::string& path) {
  return FileError(path + ": is damaged; start the run again without it");
}

/// Numbers of samples that a run can have or request.
bool are_counts(const std::vector<double>& samples) {
  constexpr double kMost = 1 << 30;
  return std::all_of(samples.begin(), samples.end(),
                     [](double count) { return count >= 0 && count <= kMost; });
}

Film read_film(Reader& reader, const std::string& path) {
  std::array<std::int32_t, 6> shape{};
  for (auto& value : shape) value = reader.number<std::int32_t>();
  const auto sum = reader.number<std::uint64_t>();
  // A damaged shape must not allocate memory that the file cannot fill.
  constexpr std::int32_t kMost = 1 << 24;
  const bool is_empty =
      std::all_of(shape.begin(), shape.end(), [](auto value) { return value == 0; });
  for (std::size_t i = 2; i < 6; ++i)
    if (!is_empty && (shape[i] < 1 || shape[i] > kMost)) throw damaged_state(path);
  const double tile_area = static_cast<double>(Film::kTile) * Film::kTile;
  if (static_cast<double>(shape[2]) * shape[3] / tile_area > static_cast<double>(reader.left()))
    throw damaged_state(path);
  Film film;
  if (!is_empty) film = Film({shape[0], shape[1], shape[2], shape[3]}, shape[4], shape[5]);
  const std::size_t count = film.all_tile_samples().size();
  const std::string_view tiles = reader.take(count * sizeof(double));
  const auto goal_count = reader.number<std::uint64_t>();
  if (goal_count != 0 && goal_count != count) throw damaged_state(path);
  const std::string_view goals = reader.take(static_cast<std::size_t>(goal_count) * sizeof(double));
  const std::string_view present = reader.take(count);
  Fnv found;
  found.add(bytes_of(shape.data(), shape.size()));
  for (const std::string_view part : {tiles, goals, present}) found.add(part);
  film.tile_goals().resize(static_cast<std::size_t>(goal_count));
  if (!goals.empty()) std::memcpy(film.tile_goals().data(), goals.data(), goals.size());
  if (!tiles.empty()) std::memcpy(film.all_tile_samples().data(), tiles.data(), tiles.size());
  if (!are_counts(film.tile_goals()) || !are_counts(film.all_tile_samples()))
    throw damaged_state(path);
  for (std::size_t i = 0; i < count; ++i) {
    const int tile = static_cast<int>(i);
    if (present[i] == kNothing) continue;
    if (present[i] != kSums) throw damaged_state(path);
    const std::string_view sums = reader.take(film.tile_values(tile) * sizeof(double));
    found.add(sums);
    std::memcpy(film.tile_sums(tile).data(), sums.data(), sums.size());
  }
  if (found.value() != sum) throw damaged_state(path);
  return film;
}

}  // namespace

void write_checkpoint(const std::string& path, const Film& film, const std::string& key) {
  write_checkpoint(path, std::vector{&film}, key);
}

void write_checkpoint(const std::string& path, const std::vector<const Film*>& films,
                      const std::string& key) {
  AtomicFile file(path);
  const std::uint64_t key_size = key.size(), count = films.size();
  file.write(kMagic);
  file.write(bytes_of(&key_size, 1));
  file.write(key);
  file.write(bytes_of(&count, 1));
  for (const Film* film : films) write_film(*film, file);
  file.commit();
}

std::string read_checkpoint_key(const std::string& path) {
  // Only the beginning: the film may take much more memory than there is twice.
  std::ifstream file(path, std::ios::binary);
  if (!file) throw FileError("cannot read '" + path + "'");
  std::string magic(kMagic.size(), '\0');
  file.read(magic.data(), static_cast<std::streamsize>(magic.size()));
  if (!file || magic != kMagic) throw FileError(path + ": is not the state of an interrupted run");
  std::uint64_t size = 0;
  file.read(reinterpret_cast<char*>(&size), sizeof size);
  std::error_code error;
  const auto whole = std::filesystem::file_size(path, error);
  std::string key;
  if (file && !error && size <= whole) {
    key.resize(static_cast<std::size_t>(size));
    file.read(key.data(), static_cast<std::streamsize>(size));
  }
  if (!file || key.size() != size)
    throw FileError(path + ": is damaged (too short); start the run again without it");
  return key;
}

std::vector<Film> read_checkpoint_films(const std::string& path, const std::string& key) {
  const std::string text = read_file(path);
  Reader reader(path, text);
  if (text.size() < kMagic.size() || reader.take(kMagic.size()) != kMagic)
    throw FileError(path + ": is not the state of an interrupted run");
  const auto key_size = reader.number<std::uint64_t>();
  if (reader.take(static_cast<std::size_t>(key_size)) != key)
    throw InputError(path +
                     ": belongs to another scene, to other settings or to another version; "
                     "give the same as for the run that was stopped");
  const auto count = reader.number<std::uint64_t>();
  std::vector<Film> films;
  // A damaged count ends where the file does.
  for (std::uint64_t i = 0; i < count; ++i) films.push_back(read_film(reader, path));
  if (reader.left() != 0) throw damaged_state(path);
  return films;
}

Film read_checkpoint(const std::string& path, const std::string& key) {
  std::vector<Film> films = read_checkpoint_films(path, key);
  if (films.size() != 1) throw damaged_state(path);
  return std::move(films.front());
}

}  // namespace plenoflame
