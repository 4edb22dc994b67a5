#include "plenoflame/film/reopened.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>
#include <vector>

#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

/// Places of replicates about their mean, in units of the standard error of the mean: their scatter
/// gives that standard error again.
std::vector<double> places_about_mean(int replicates) {
  std::vector<double> places(static_cast<std::size_t>(replicates), 0.0);
  if (replicates < 2) return places;
  // With a of them on each side at the distance d, the squared error is 2 a d^2 / (n (n - 1)).
  const double distance = replicates % 2 == 0 ? std::sqrt(replicates - 1.0)
                                              : std::sqrt(static_cast<double>(replicates));
  for (std::size_t r = 0; r + 1 < places.size(); r += 2) {
    places[r] = distance;
    places[r + 1] = -distance;
  }
  return places;
}

void reopen(const Film& film, int tile, Film& open) {
  const std::vector<float> values = film.finished_values(tile);
  std::vector<double>& sums = open.tile_sums(tile);
  const std::vector<double> places = places_about_mean(film.replicates());
  const std::size_t pixels =
      film.tile_values(tile) / static_cast<std::size_t>(film.channels()) / places.size();
  const double samples = film.tile_samples(tile);
  auto flux = values.begin();
  auto sum = sums.begin();
  for (int channel = 0; channel < film.channels(); ++channel) {
    const auto error = flux + static_cast<std::ptrdiff_t>(pixels);
    for (const double place : places)
      for (std::size_t i = 0; i < pixels; ++i) {
        const auto at = static_cast<std::ptrdiff_t>(i);
        const double off = places.size() > 1 ? place * static_cast<double>(error[at]) : 0.0;
        *sum++ = samples * (static_cast<double>(flux[at]) + off);
      }
    flux = error + static_cast<std::ptrdiff_t>(places.size() > 1 ? pixels : 0);
  }
}

}  // namespace

std::string tile_samples_text(const Film& film) {
  const std::vector<double>& samples = film.all_tile_samples();
  if (std::adjacent_find(samples.begin(), samples.end(), std::not_equal_to<>()) == samples.end())
    return "";
  std::string text;
  for (auto at = samples.begin(); at != samples.end();) {
    const auto next = std::find_if(at, samples.end(), [&](double s) { return s != *at; });
    text += fmt::format("{}{}x{}", text.empty() ? "" : " ", next - at, *at);
    at = next;
  }
  return text;
}

std::vector<double> tile_samples_of(const LightField& picture, int replicates, int tiles) {
  const auto fail = [] {
    return InputError("the light field does not say how many samples its parts have");
  };
  const auto text = picture.texts.find(kTileSamples);
  const auto count = static_cast<std::size_t>(tiles);
  if (text == picture.texts.end())
    return std::vector<double>(count, std::round(picture.samples / replicates));
  std::vector<double> samples;
  std::istringstream words(text->second);
  for (std::string word; words >> word;) {
    std::size_t run = 0;
    double each = 0;
    const char* const end = word.data() + word.size();
    const auto first = std::from_chars(word.data(), end, run);
    if (first.ec != std::errc() || first.ptr == end || *first.ptr != 'x' ||
        run > count - samples.size())
      throw fail();
    const auto second = std::from_chars(first.ptr + 1, end, each);
    if (second.ec != std::errc() || second.ptr != end || !(each >= 0) || !std::isfinite(each))
      throw fail();
    samples.insert(samples.end(), run, each);
  }
  if (samples.size() != count) throw fail();
  return samples;
}

Film film_of(const LightField& picture) {
  const auto replicates = picture.numbers.find("render.replicates");
  if (replicates == picture.numbers.end() || !(replicates->second >= 1 && replicates->second <= 64))
    throw InputError("the light field does not say from how many replicates its errors are");
  const int count = static_cast<int>(replicates->second);
  Film film(picture.window, static_cast<int>(picture.channels.size()), count);
  for (const LightFieldChannel& channel : picture.channels)
    if (count > 1 && channel.standard_error.empty())
      throw InputError("the light field has no standard errors, which more samples need");
  const std::vector<double> samples = tile_samples_of(picture, count, film.tile_count());
  std::vector<float> values;
  for (int tile = 0; tile < film.tile_count(); ++tile) {
    const PixelWindow pixels = film.tile(tile);
    values.clear();
    for (const LightFieldChannel& channel : picture.channels)
      for (const Image* image : {&channel.flux, &channel.standard_error}) {
        if (count < 2 && image == &channel.standard_error) continue;
        for (int row = 0; row < pixels.height; ++row)
          for (int column = 0; column < pixels.width; ++column)
            values.push_back(
                image->at(pixels.x - picture.window.x + column, pixels.y - picture.window.y + row));
      }
    film.add_samples(tile, samples[static_cast<std::size_t>(tile)]);
    if (std::any_of(values.begin(), values.end(), [](float value) { return value != 0; }))
      film.set_finished(tile, values);
  }
  return film;
}

Film reopened(const Film& film) {
  Film open(film.window(), film.channels(), film.replicates());
  open.all_tile_samples() = film.all_tile_samples();
  open.tile_goals() = film.tile_goals();
  for (int tile = 0; tile < film.tile_count(); ++tile) {
    if (film.is_finished(tile))
      reopen(film, tile, open);
    else if (!film.tile_sums(tile).empty())
      open.tile_sums(tile) = film.tile_sums(tile);
  }
  return open;
}

}  // namespace plenoflame
