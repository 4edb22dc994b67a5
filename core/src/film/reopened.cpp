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
  film.all_tile_samples() = tile_samples_of(picture, count, film.tile_count());
  const std::vector<double> places = places_about_mean(count);
  for (int tile = 0; tile < film.tile_count(); ++tile) {
    const PixelWindow pixels = film.tile(tile);
    const double samples = film.tile_samples(tile);
    std::vector<double> sums;
    for (const LightFieldChannel& channel : picture.channels)
      for (const double place : places)
        for (int row = 0; row < pixels.height; ++row)
          for (int column = 0; column < pixels.width; ++column) {
            const int x = pixels.x - picture.window.x + column,
                      y = pixels.y - picture.window.y + row;
            const double off =
                count > 1 ? place * static_cast<double>(channel.standard_error.at(x, y)) : 0;
            sums.push_back(samples * (static_cast<double>(channel.flux.at(x, y)) + off));
          }
    if (std::any_of(sums.begin(), sums.end(), [](double sum) { return sum != 0; }))
      film.tile_sums(tile) = std::move(sums);
  }
  return film;
}

}  // namespace plenoflame
