// Everything by which kinds of channels differ: a row of functions for each.
#include "plenoflame/scene/channel_kinds.h"

#include <fmt/format.h>

#include <utility>

#include "plenoflame/base/units.h"
#include "scene/schema/nearest.h"
#include "scene/validation/channel_kind_checks.h"

namespace plenoflame {
namespace {

using Response = std::optional<SpectralResponse>;

struct ChannelKindRow {
  ChannelKind kind;
  Response (*response)(const ChannelSpec&);
  double (*own_wavelength)(const ChannelSpec&);
  std::string (*describe)(const ChannelSpec&);
  void (*check)(const ChannelSpec&, const std::string& path, Issues&);
};

double none(const ChannelSpec&) {
  return 0;
}
double centre(const ChannelSpec& channel) {
  return channel.wavelength;
}

std::string quantum(const ChannelSpec& channel) {
  return channel.photons ? ", counting photons" : "";
}

std::string wide(const ChannelSpec& channel, const char* where) {
  return readable_quantity(channel.width, Dimension::length) + where +
         readable_quantity(channel.wavelength, Dimension::length) + quantum(channel);
}

std::string describe_curve(const ChannelSpec& channel) {
  return (channel.file.empty() ? std::string("curve") : "curve of '" + channel.file + "'") +
         quantum(channel);
}

std::string name_in_words(const ChannelSpec& channel) {
  return "channel " + quote_for_message(channel.name);
}

void check_total(const ChannelSpec& channel, const std::string& path, Issues& issues) {
  if (channel.wavelength == 0 && channel.width == 0) return;
  issues.warning(path, name_in_words(channel) +
                           " measures all wavelengths, so its wavelength and width are not used; "
                           "set kind = \"band\" for a band");
}

/// @param what the kind for people @param widest width over wavelength at which it begins at 0
void check_around(const ChannelSpec& channel, const std::string& path, Issues& issues,
                  const char* what, double widest) {
  const std::string name = name_in_words(channel);
  if (channel.wavelength <= 0)
    issues.error(path + ".wavelength",
                 fmt::format("{} is a {} and needs a wavelength", name, what));
  if (channel.width <= 0)
    issues.error(path + ".width", fmt::format("{} is a {} and needs a width", name, what));
  if (channel.wavelength > 0 && channel.width >= widest * channel.wavelength)
    issues.error(path + ".width",
                 fmt::format("{} has a {} that begins at or below a wavelength of 0", name, what));
}

/// Tells whether a response can be made at all.
void check_response(const ChannelSpec& channel, const std::string& key, Issues& issues) {
  issues.expect(key, name_in_words(channel), [&] { static_cast<void>(response_of_kind(channel)); });
}

void check_curve(const ChannelSpec& channel, const std::string& path, Issues& issues) {
  if (!channel.curve.empty())
    check_response(channel, path + ".curve", issues);
  else if (channel.file.empty())
    issues.error(path, name_in_words(channel) + " is a curve and needs a file, or points in curve");
}

constexpr ChannelKindRow kRows[]{
    {ChannelKind::total, [](const ChannelSpec&) { return Response(); }, none,
     [](const ChannelSpec&) { return std::string("all wavelengths"); }, check_total},
    {ChannelKind::band,
     [](const ChannelSpec& channel) {
       return Response(SpectralResponse::band(channel.wavelength, channel.width));
     },
     centre, [](const ChannelSpec& channel) { return wide(channel, " around "); },
     [](const ChannelSpec& channel, const std::string& path, Issues& issues) {
       check_around(channel, path, issues, "band", 2);
     }},
    {ChannelKind::line,
     [](const ChannelSpec& channel) {
       return Response(SpectralResponse::gaussian(channel.wavelength, channel.width));
     },
     centre, [](const ChannelSpec& channel) { return wide(channel, " wide line at "); },
     [](const ChannelSpec& channel, const std::string& path, Issues& issues) {
       check_around(channel, path, issues, "line filter", 1);
     }},
    {ChannelKind::curve,
     [](const ChannelSpec& channel) {
       return Response(SpectralResponse::curve(parse_spectral_points(channel.curve)));
     },
     none, describe_curve, check_curve},
    {ChannelKind::named,
     [](const ChannelSpec& channel) { return Response(SpectralResponse::named(channel.response)); },
     none,
     [](const ChannelSpec& channel) { return "response " + channel.response + quantum(channel); },
     [](const ChannelSpec& channel, const std::string& path, Issues& issues) {
       check_response(channel, path + ".response", issues);
     }},
};

const ChannelKindRow& row_of(const ChannelSpec& channel) {
  for (const ChannelKindRow& row : kRows)
    if (row.kind == channel.kind) return row;
  return kRows[0];
}

}  // namespace

std::optional<SpectralResponse> response_of_kind(const ChannelSpec& channel) {
  return row_of(channel).response(channel);
}

double own_wavelength(const ChannelSpec& channel) {
  return row_of(channel).own_wavelength(channel);
}

std::string describe_channel(const ChannelSpec& channel) {
  return row_of(channel).describe(channel);
}

void check_channel_kind(const ChannelSpec& channel, const std::string& path, Issues& issues) {
  row_of(channel).check(channel, path, issues);
}

}  // namespace plenoflame
