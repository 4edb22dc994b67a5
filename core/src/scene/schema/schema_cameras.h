#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

/// Rows of the schema for "[[cameras]]": the rows of "camera" hold for each of them. Only their
/// paths differ, which are made at compile time.
namespace plenoflame::schema {

inline constexpr std::string_view kOneCamera = "camera";
inline constexpr std::string_view kCameraList = "cameras";
inline constexpr std::string_view kEachCamera = "cameras[]";

constexpr bool is_of_camera(std::string_view path) {
  return path == kOneCamera ||
         (path.starts_with(kOneCamera) && path.substr(kOneCamera.size()).starts_with('.'));
}

template <const auto& rows>
constexpr std::size_t camera_row_count() {
  return static_cast<std::size_t>(std::count_if(
      std::begin(rows), std::end(rows), [](const auto& row) { return is_of_camera(row.path); }));
}

template <const auto& rows>
constexpr std::size_t camera_path_letters() {
  std::size_t letters = 0;
  for (const auto& row : rows)
    if (is_of_camera(row.path)) letters += row.path.size() - kOneCamera.size() + kEachCamera.size();
  return letters;
}

/// The paths below "cameras[]", one behind the other.
template <const auto& rows>
constexpr auto camera_paths() {
  std::array<char, camera_path_letters<rows>()> letters{};
  std::size_t at = 0;
  for (const auto& row : rows) {
    if (!is_of_camera(row.path)) continue;
    for (const char c : kEachCamera) letters[at++] = c;
    for (const char c : row.path.substr(kOneCamera.size())) letters[at++] = c;
  }
  return letters;
}

template <const auto& rows>
inline constexpr auto kCameraPaths = camera_paths<rows>();

/// All rows, those of "camera" once more for "cameras[]", behind the last of them.
template <const auto& rows>
constexpr auto with_each_camera() {
  using Row = std::remove_cvref_t<decltype(rows[0])>;
  std::array<Row, std::size(rows) + camera_row_count<rows>()> all{};
  std::size_t to = 0;
  for (const auto& row : rows)
    if (is_of_camera(row.path)) all[to++] = row;
  std::size_t at = 0;
  for (const auto& row : rows) {
    if (!is_of_camera(row.path)) continue;
    const std::size_t letters = row.path.size() - kOneCamera.size() + kEachCamera.size();
    all[to] = row;
    all[to++].path = std::string_view(kCameraPaths<rows>.data() + at, letters);
    at += letters;
  }
  for (const auto& row : rows)
    if (!is_of_camera(row.path)) all[to++] = row;
  return all;
}

}  // namespace plenoflame::schema
