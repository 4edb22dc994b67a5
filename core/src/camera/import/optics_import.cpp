/// Distances without a grid, or with a nominal grid: plenoptomos' .ini, and the models of virtual
/// depth of Bok, Nousias and O'Brien.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <sstream>

#include "camera/import/found_camera.h"

namespace plenoflame {
namespace {

constexpr double kOpticsMillimetre = 1e-3;

std::string trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return "";
  return std::string(text.substr(first, text.find_last_not_of(" \t\r") - first + 1));
}

std::optional<double> number_in(const std::string& text) {
  double value = 0;
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

}  // namespace

namespace {

/// Separates keys with numbers from names of makers and models.
bool is_plenoptomos_number(const std::string& key) {
  constexpr std::array<std::string_view, 17> kKeys{"sensor.size_x",
                                                   "sensor.size_y",
                                                   "sensor.pixel_size_x",
                                                   "sensor.pixel_size_y",
                                                   "sensor.x",
                                                   "sensor.y",
                                                   "sensor.z",
                                                   "main_lens.f1",
                                                   "main_lens.aperture",
                                                   "micro_lenses_array.x",
                                                   "micro_lenses_array.y",
                                                   "micro_lenses_array.z",
                                                   "micro_lens.f2",
                                                   "micro_lens.size_x",
                                                   "micro_lens.size_y",
                                                   "micro_lens.physical_size_s",
                                                   "micro_lens.physical_size_t"};
  return std::find(kKeys.begin(), kKeys.end(), key) != kKeys.end();
}

}  // namespace

bool is_plenoptomos(const CalibrationFile& file) {
  return file.text.find("[micro_lenses_array]") != std::string::npos;
}

void read_plenoptomos(const CalibrationFile& file, FoundCamera& found) {
  std::map<std::string, double> values;
  std::istringstream lines(file.text);
  std::string line, section;
  for (int number = 1; std::getline(lines, line); ++number) {
    line = trimmed(line);
    if (line.empty() || line[0] == '#' || line[0] == ';') continue;
    if (line.front() == '[' && line.back() == ']') {
      section = line.substr(1, line.size() - 2);
      continue;
    }
    const std::size_t equals = line.find('=');
    if (equals == std::string::npos)
      throw InputError(SourcePosition{file.path, number}, "neither [section] nor name = value");
    const std::string key = section + "." + trimmed(line.substr(0, equals));
    const std::string text = trimmed(line.substr(equals + 1));
    if (const std::optional<double> value = number_in(text))
      values[key] = *value;
    else if (!text.empty() && is_plenoptomos_number(key))
      refuse_calibration(file, key + " is no number");
  }
  take_plenoptomos(file, values, false, found);
}

void take_plenoptomos(const CalibrationFile& file, const std::map<std::string, double>& values,
                      bool aperture_is_length, FoundCamera& found) {
  const auto value = [&](const std::string& key) {
    const auto at = values.find(key);
    return at == values.end() ? 0.0 : at->second;
  };
  const auto length = [&](const std::string& key) { return kOpticsMillimetre * value(key); };
  const auto positive = [&](const std::string& key, double v) {
    if (v < 0) refuse_calibration(file, key + " is below 0");
    return v;
  };
  CameraSpec& camera = found.camera;
  SensorSpec& sensor = camera.sensor;
  for (const char* key : {"sensor.size_x", "sensor.size_y"})
    if (!(value(key) >= 0 && value(key) <= 65536))
      refuse_calibration(file, std::string(key) + " is no number of pixels");
  set_new(sensor.columns, static_cast<int>(value("sensor.size_x")));
  set_new(sensor.rows, static_cast<int>(value("sensor.size_y")));
  set_new(sensor.pixel_pitch, positive("sensor.pixel_size_x", length("sensor.pixel_size_x")));
  // A given width applies to square pixels; the file's height is then ignored.
  const double pixel_y = length("sensor.pixel_size_y");
  if (pixel_y > 0 && sensor.pixel_pitch == length("sensor.pixel_size_x") &&
      pixel_y != sensor.pixel_pitch)
    set_new(sensor.pixel_pitch_y, pixel_y);
  const double f = length("main_lens.f1"), n = value("main_lens.aperture");
  set_new(camera.lens.focal_length, positive("main_lens.f1", f));
  const double z_array = length("micro_lenses_array.z"), z_sensor = length("sensor.z");
  if (n > 0 && f > 0) {
    // Files hold f-numbers or diameters in mm without naming which. We use the reading with which
    // micro-images are nearer to filling their cells.
    const double cell = length("micro_lens.physical_size_s");
    const double seen = z_array > 0 ? (z_sensor - z_array) / z_array : 0;
    const double by_number = f / n, as_length = kOpticsMillimetre * n;
    const auto misfit = [&](double diameter) {
      return std::fabs(std::log(diameter * seen / cell));
    };
    const bool is_length =
        aperture_is_length || (cell > 0 && seen > 0 && misfit(as_length) < misfit(by_number));
    set_new(camera.lens.diameter, is_length ? as_length : by_number);
    if (is_length && !aperture_is_length)
      found.note(
          "main_lens.aperture is taken for a diameter in mm: as an f-number it would make "
          "micro-images far from the size of a microlens (camera.lens.diameter)");
  }
  if (z_array > 0) {
    camera.focus.mode = FocusMode::distance;
    set_new(camera.focus.lens_distance, z_array);
    if (z_sensor > 0) {
      if (!(z_sensor > z_array))
        refuse_calibration(file,
                           "the sensor (sensor.z) does not stand behind the array "
                           "(micro_lenses_array.z)");
      set_new(camera.array.sensor_distance, z_sensor - z_array);
    }
  }
  ArraySpec& array = camera.array;
  if (array.types.empty()) array.types.resize(1);
  set_new(array.types[0].focal_length, length("micro_lens.f2"));
  const double pitch = length("micro_lens.physical_size_s"),
               pitch_y = length("micro_lens.physical_size_t");
  if (pitch > 0 && !found.grid && !found.placed) {
    array.lattice = Lattice::square;
    set_new(array.pitch, pitch);
    if (pitch_y > 0 && pitch_y != pitch && array.pitch == pitch) set_new(array.pitch_y, pitch_y);
    // The offset is relative to the middle of the sensor, like the camera's axis.
    array.offset = {length("micro_lenses_array.x") - length("sensor.x"),
                    length("micro_lenses_array.y") - length("sensor.y")};
    camera.lens.decentre = {-length("sensor.x"), -length("sensor.y")};
    found.placed = true;
    found.note(
        "the file gives nominal values: the array's rotation and the place of its lenses to "
        "a fraction of a pitch are not in it (camera.array.rotation, camera.array.offset)");
  }
}

namespace {

/// Numbers of a text, with names ("K1 = -2.1") or without.
struct PlainNumbers {
  std::vector<std::pair<std::string, double>> named;
  std::vector<double> bare;
  bool other = false;  ///< the text holds something else
};

PlainNumbers plain_numbers(const std::string& text) {
  PlainNumbers result;
  std::istringstream lines(text);
  std::string line;
  while (std::getline(lines, line)) {
    const std::size_t comment = line.find_first_of("#%");
    line = trimmed(line.substr(0, comment));
    if (line.empty()) continue;
    if (const std::size_t equals = line.find('='); equals != std::string::npos) {
      std::string value = trimmed(line.substr(equals + 1));
      while (!value.empty() && (value.back() == ';' || value.back() == ',')) value.pop_back();
      const std::optional<double> number = number_in(trimmed(value));
      if (!number) result.other = true;
      result.named.emplace_back(trimmed(line.substr(0, equals)), number.value_or(0));
      continue;
    }
    std::replace(line.begin(), line.end(), ',', ' ');
    std::replace(line.begin(), line.end(), '\t', ' ');
    std::istringstream words(line);
    std::string word;
    while (words >> word) {
      const std::optional<double> number = number_in(word);
      if (!number) {
        result.other = true;
        return result;
      }
      result.bare.push_back(*number);
    }
  }
  return result;
}

/// u - u_c = (fx X / Z - (u_c - cx)) / (K1 + K2 / Z) for the micro-image with its centre at u_c.
struct VirtualDepthModel {
  double k1 = 0, k2 = 0, fx = 0, fy = 0, cx = 0, cy = 0;
  double radial = 0;  ///< O'Brien's radial term, per pixel^2
};

}  // namespace

bool is_ten_parameters(const CalibrationFile& file) {
  if (file.text.find('{') != std::string::npos || file.text.find('<') != std::string::npos)
    return false;
  const PlainNumbers numbers = plain_numbers(file.text);
  if (!numbers.named.empty())
    return std::any_of(numbers.named.begin(), numbers.named.end(),
                       [](const auto& pair) { return pair.first == "K1"; });
  return !numbers.other && numbers.bare.size() >= 8;
}

void read_ten_parameters(const CalibrationFile& file, FoundCamera& found) {
  const PlainNumbers numbers = plain_numbers(file.text);
  if (numbers.other) refuse_calibration(file, "holds something that is no number, or not finite");
  std::vector<VirtualDepthModel> types;
  if (!numbers.named.empty()) {
    // A second K1 begins the next type.
    for (const auto& [name, value] : numbers.named) {
      if (name == "K1") types.emplace_back();
      if (types.empty()) refuse_calibration(file, "begins with " + name + ", not with K1");
      VirtualDepthModel& m = types.back();
      double* const place = name == "K1"   ? &m.k1
                            : name == "K2" ? &m.k2
                            : name == "fx" ? &m.fx
                            : name == "fy" ? &m.fy
                            : name == "cx" ? &m.cx
                            : name == "cy" ? &m.cy
                            : name == "c1" ? &m.radial
                                           : nullptr;
      if (place)
        *place = value;
      else if (value != 0)
        found.note("'" + name + "' is left out: the model does not use it, or it is not known");
    }
  } else if (numbers.bare.size() % 8 == 0 && numbers.bare.size() <= 24) {
    for (std::size_t i = 0; i < numbers.bare.size(); i += 8) {
      const double* b = &numbers.bare[i];
      types.push_back({b[0], b[1], b[2], b[3], b[4], b[5], 0});
      if (b[6] != 0 || b[7] != 0)
        found.note(
            "k1 and k2 of Nousias' vector are left out: his own projection does not use "
            "them");
    }
  } else if (numbers.bare.size() >= 12) {
    // The file holds O'Brien's matrix by rows, then poses.
    const std::vector<double>& b = numbers.bare;
    types.push_back({b[0], b[1], b[2], b[5], b[4], b[3], b[6]});
  } else {
    refuse_calibration(file, "has " + std::to_string(numbers.bare.size()) +
                                 " numbers; 8 for each type (K1 K2 fx fy cx cy k1 k2) or rows of 3 "
                                 "from 4 on are expected");
  }
  if (types.size() > 3) refuse_calibration(file, "has more than three types");
  VirtualDepthModel mean;
  for (const VirtualDepthModel& m : types) {
    if (!(m.fx > 0 && m.fy > 0) || m.k1 == 0 || m.k2 == 0)
      refuse_calibration(file, "K1, K2, fx and fy are needed; fx and fy are above 0");
    const double n = static_cast<double>(types.size());
    mean.k1 += m.k1 / n, mean.k2 += m.k2 / n, mean.fx += m.fx / n, mean.fy += m.fy / n;
    mean.cx += m.cx / n, mean.cy += m.cy / n, mean.radial += m.radial / n;
  }
  if (types.size() > 1)
    found.note(
        "the model lets each type of microlens have a camera of its own; their mean was "
        "taken, as array and sensor are in one place");
  CameraSpec& camera = found.camera;
  SensorSpec& sensor = camera.sensor;
  // T is the distance from the lens to the sensor, D to the array, and B between them. Then fx = T
  // / p, K2 = T D / B and K1 = -(T / B) (D / f - 1). The file does not hold p.
  if (!(sensor.pixel_pitch > 0)) {
    found.note("fx counts in pixels, and all distances follow from the size of one");
    return;
  }
  const double total = mean.fx * sensor.pixel_pitch;
  if (mean.fy != mean.fx) set_new(sensor.pixel_pitch_y, total / mean.fy);
  // K2 may have either sign; we use the sign for which depth increases away from the lens.
  const double k2 = kOpticsMillimetre * std::fabs(mean.k2), k1 = mean.k2 > 0 ? mean.k1 : -mean.k1;
  const double gap = total * total / (k2 + total), distance = total - gap;
  const double inverse = (1 - k1 * gap / total) / distance;
  if (!(inverse > 0))
    refuse_calibration(file, "no thin main lens has these K1 and K2 (in mm) with this pixel pitch");
  set_new(camera.array.sensor_distance, gap);
  camera.focus.mode = FocusMode::distance;
  set_new(camera.focus.lens_distance, distance);
  set_new(camera.lens.focal_length, 1 / inverse);
  // In the file pixels count from 1, at their centres.
  if (sensor.columns > 0 && sensor.rows > 0)
    camera.lens.decentre = {(0.5 * sensor.columns - (mean.cx - 0.5)) * sensor.pixel().x,
                            (0.5 * sensor.rows - (mean.cy - 0.5)) * sensor.pixel().y};
  if (mean.radial != 0)
    found.note("the distortion of the main lens (c1) has no key in a scene: left out");
  if (camera.array.types.empty()) camera.array.types.resize(types.size());
}

}  // namespace plenoflame
