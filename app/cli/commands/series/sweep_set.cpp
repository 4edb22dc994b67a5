#include "commands/series/sweep_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>

#include "commands/render/light_field_output.h"
#include "file_set.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/array_set.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/image/light_field.h"

namespace plenoflame::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// @param check reads all used values of the file
Json read_json(const std::string& path, const std::function<void(const Json&)>& check) {
  try {
    Json json = Json::parse(read_file(path));
    check(json);
    return json;
  } catch (const Json::exception&) {
  } catch (const InputError&) {
  } catch (const UsageError&) {
  }
  throw FileError("'" + path + "' is damaged or does not belong to a sweep");
}

/// @throws Json::exception, InputError for missing values and wrong types
void check_plan(const Json& plan) {
  static_cast<void>(part_from(plan.at("part").get<std::string>()));
  for (const char* text : {"format", "version"}) plan.at(text).get<std::string>();
  plan.at("runs").get<int>();
  if (!plan.contains("lattice")) return;
  const Json& lattice = plan.at("lattice");
  for (const char* numbers : {"cells", "lower_m", "upper_m"})
    for (std::size_t i = 0; i < 3; ++i) lattice.at(numbers).at(i).get<double>();
}

/// The same of a run. @param lattice the sweep has one
void check_record(const Json& record, bool lattice) {
  record.at("run").get<int>();
  record.at("seed").get<std::int64_t>();
  record.at("split").get<std::string>();
  record.value("beyond_lattice", false);
  for (const auto& [key, value] : record.at("values").items()) value.get<std::string>();
  if (lattice || record.contains("lines")) record.at("lines").get<std::vector<std::string>>();
  for (const Json& picture : record.at("pictures")) {
    for (const char* text : {"camera", "file"}) picture.at(text).get<std::string>();
    for (const char* number : {"flux_W", "relative_error"}) static_cast<void>(picture.at(number));
  }
}

/// Record of a finished run.
Json read_record(const std::string& folder, int run, const Json& plan) {
  return read_json(folder + "/runs/" + run_name(run) + ".json",
                   [&](const Json& record) { check_record(record, plan.contains("lattice")); });
}

std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string cell = "\"";
  for (const char c : text) cell += c == '"' ? std::string("\"\"") : std::string(1, c);
  return cell + "\"";
}

/// Keys to which any run gives a value, in the order in which they come.
std::vector<std::string> keys_of(const std::vector<Json>& records) {
  std::vector<std::string> keys;
  for (const Json& record : records)
    for (const auto& [key, value] : record.at("values").items())
      if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
  return keys;
}

std::string index_of(const std::vector<Json>& records, bool packed) {
  const std::vector<std::string> keys = keys_of(records);
  std::string text = "run,split,seed,camera,picture,flux_W,relative_error";
  for (const std::string& key : keys) text += "," + csv_cell(key);
  text += "\n";
  for (const Json& record : records)
    for (const Json& picture : record.at("pictures")) {
      text += fmt::format("{},{},{},{},{},{},{}", record.at("run").get<int>(),
                          record.at("split").get<std::string>(), record.at("seed").dump(),
                          csv_cell(picture.at("camera").get<std::string>()),
                          packed ? "set.h5" : "runs/" + picture.at("file").get<std::string>(),
                          picture.at("flux_W").dump(), picture.at("relative_error").dump());
      for (const std::string& key : keys)
        text += "," + csv_cell(record.at("values").value(key, std::string()));
      text += "\n";
    }
  return text;
}

/// Numbers with their common unit; nothing when a text is none.
struct Numbers {
  std::vector<double> values;
  std::string unit;
  bool are = true, any = false;

  void add(const std::string& text) {
    double value = std::numeric_limits<double>::quiet_NaN();
    if (!text.empty()) {
      const char* const end = text.data() + text.size();
      const auto [stop, error] = std::from_chars(text.data(), end, value);
      std::string rest(stop, end);
      rest.erase(0, rest.find_first_not_of(' '));
      are = are && error == std::errc() && (!any || rest == unit) &&
            rest.find(',') == std::string::npos;
      unit = rest;
      any = true;
    }
    values.push_back(value);
  }
};

void add_parameters(const std::vector<Json>& records, ArraySetWriter& file) {
  for (const std::string& key : keys_of(records)) {
    Numbers numbers;
    std::vector<std::string> texts;
    for (const Json& record : records) {
      texts.push_back(record.at("values").value(key, std::string()));
      numbers.add(texts.back());
    }
    if (numbers.are && numbers.any)
      file.numbers("parameters/" + key, numbers.values, numbers.unit);
    else
      file.texts("parameters/" + key, texts);
  }
}

/// Pictures of a camera: images of all channels, layers.
void put_picture(const std::string& path, const std::string& group, std::size_t row,
                 std::size_t rows, ArraySetWriter& file) {
  const LightField field = read_light_field(path);
  const auto size = [](const Image& image) {
    return std::vector<std::size_t>{static_cast<std::size_t>(image.height),
                                    static_cast<std::size_t>(image.width)};
  };
  std::map<std::string, std::pair<const Image*, std::string>> images;
  for (const LightFieldChannel& channel : field.channels) {
    images["picture/" + channel.name] = {&channel.flux, field.unit};
    if (!channel.standard_error.empty())
      images["picture_error/" + channel.name] = {&channel.standard_error, field.unit};
  }
  for (const auto& [name, image] : field.layers) images["layers/" + name] = {&image, ""};
  for (const auto& [name, image] : images) {
    if (row == 0) file.rows(group + name, rows, size(*image.first), image.second, "run,row,column");
    file.put(group + name, row, image.first->pixels);
  }
}

void write_set(const std::string& name, const std::string& folder, const Json& plan,
               const std::vector<Json>& records, const std::stop_token& stop) {
  ArraySetWriter file(name);
  file.attribute("/", "sweep", plan.dump(2));
  file.attribute("/", "version", plan.at("version").get<std::string>());
  std::vector<std::int64_t> runs, test, seeds;
  std::vector<std::string> lines;
  for (const Json& record : records) {
    runs.push_back(record.at("run").get<std::int64_t>());
    test.push_back(record.at("split").get<std::string>() == "test" ? 1 : 0);
    seeds.push_back(record.at("seed").get<std::int64_t>());
    if (record.contains("lines"))
      for (const Json& line : record.at("lines"))
        if (std::find(lines.begin(), lines.end(), line.get<std::string>()) == lines.end())
          lines.push_back(line.get<std::string>());
  }
  file.whole_numbers("run", runs);
  file.whole_numbers("test", test);
  file.whole_numbers("seed", seeds);
  add_parameters(records, file);
  for (std::size_t row = 0; row < records.size(); ++row) {
    if (stop.stop_requested()) throw Cancelled();
    const Json& record = records[row];
    const std::string base = folder + "/runs/" + run_name(record.at("run").get<int>());
    for (const Json& picture : record.at("pictures")) {
      const std::string camera = picture.at("camera").get<std::string>();
      put_picture(folder + "/runs/" + picture.at("file").get<std::string>(),
                  camera.empty() ? "" : camera + "/", row, records.size(), file);
    }
    if (!plan.contains("lattice")) continue;
    const auto put = [&](const std::string& from, const char* unit) {
      const StoredArray array = read_stored_array(base + ".truth.h5", from);
      const std::string path = "truth/" + from;
      if (row == 0)
        file.rows(path, records.size(), {array.shape.begin() + 1, array.shape.end()}, unit,
                  "run,z,y,x");
      file.put(path, row, array.values);
    };
    put("temperature", "K");
    put("absorption", "1/m");
    const auto here = record.at("lines").get<std::vector<std::string>>();
    for (const std::string& line : lines) {
      if (row == 0 && std::find(here.begin(), here.end(), line) == here.end()) {
        const auto cells = plan.at("lattice").at("cells").get<std::vector<std::size_t>>();
        file.rows("truth/lines/" + line, records.size(), {cells[2], cells[1], cells[0]}, "W/m^3",
                  "run,z,y,x");
      }
      if (std::find(here.begin(), here.end(), line) != here.end()) put("lines/" + line, "W/m^3");
    }
    if (row == 0)
      for (const char* corner : {"lower_m", "upper_m"})
        file.attribute("truth", corner, plan.at("lattice").at(corner).get<std::vector<double>>());
  }
  file.close();
}

}  // namespace

bool run_is_done(const std::string& folder, int run) {
  std::error_code error;
  return fs::exists(folder + "/runs/" + run_name(run) + ".json", error);
}

std::vector<int> finish_set(const std::string& folder, const Json& plan,
                            const std::vector<int>& runs, bool pack, const std::stop_token& stop) {
  std::vector<Json> records;
  std::vector<int> beyond;
  for (const int run : runs) {
    records.push_back(read_record(folder, run, plan));
    if (records.back().value("beyond_lattice", false)) beyond.push_back(run);
  }
  FileSet files;
  if (pack)
    files.write(folder + "/set.h5",
                [&](const std::string& name) { write_set(name, folder, plan, records, stop); });
  files.write(folder + "/index.csv",
              [&](const std::string& name) { write_file(name, index_of(records, pack)); });
  files.commit();
  std::error_code error;
  if (pack) fs::remove_all(folder + "/runs", error);
  return beyond;
}

std::string beyond_lattice_warning(const std::vector<int>& runs) {
  if (runs.empty()) return "";
  const std::string which =
      runs.size() == 1 ? fmt::format("the flame of run {} reaches", runs.front())
                       : fmt::format("the flames of {} runs, the first of them run {}, reach",
                                     runs.size(), runs.front());
  return which +
         " beyond the lattice, so the truth lacks the parts outside; give a larger --region";
}

Json read_plan(const std::string& folder) {
  const std::string path = folder + "/sweep.json";
  std::error_code error;
  if (!fs::exists(path, error)) throw InputError("'" + folder + "' holds no sweep.json");
  return read_json(path, check_plan);
}

std::string plan_difference(const Json& then, const Json& now) {
  for (const auto& [key, value] : now.items())
    if (!then.contains(key) || then.at(key) != value) return key;
  for (const auto& [key, value] : then.items())
    if (!now.contains(key)) return key;
  return "";
}

std::vector<int> merge_sets(const std::vector<std::string>& parts, const std::string& output,
                            const std::stop_token& stop) {
  check_folder(output, std::nullopt);
  Json whole;
  std::map<int, std::string> folders;
  int count = 0;
  for (const std::string& folder : parts) {
    Json plan = read_plan(folder);
    const Part part = part_from(plan.at("part").get<std::string>());
    plan["part"] = "1/1";
    if (whole.empty()) {
      whole = plan;
      count = part.count;
    }
    if (const std::string other = plan_difference(whole, plan);
        !other.empty() || part.count != count)
      throw InputError(fmt::format("'{}' and '{}' belong to different sweeps: they differ in {}",
                                   folder, parts.front(), other.empty() ? "parts" : other));
    const auto [had, added] = folders.emplace(part.number, folder);
    if (!added)
      throw InputError(
          fmt::format("'{}' and '{}' are both part {}", had->second, folder, to_string(part)));
  }
  for (int number = 1; number <= count; ++number)
    if (!folders.contains(number))
      throw InputError(fmt::format("part {} of {} is missing", number, count));
  std::vector<int> runs;
  for (int run = 0; run < whole.at("runs").get<int>(); ++run) {
    runs.push_back(run);
    const std::string& folder = folders.at(run % count + 1);
    if (!run_is_done(folder, run))
      throw InputError(fmt::format("'{}' is not finished: run {} is missing", folder, run));
    read_record(folder, run, whole);  // a damaged one is named where it is
  }
  std::vector<int> beyond;
  ResultFolder result(output);
  result.write([&](const std::string& folder) {
    std::error_code error;
    fs::create_directory(folder + "/runs", error);
    for (const auto& [number, from] : folders)
      for (const fs::directory_entry& entry : fs::directory_iterator(from + "/runs", error)) {
        if (stop.stop_requested()) throw Cancelled();
        if (!entry.is_regular_file()) continue;
        const std::string to = folder + "/runs/" + entry.path().filename().string();
        write_file(to, read_file(entry.path().string()));
      }
    write_file(folder + "/sweep.json", whole.dump(2) + "\n");
    beyond = finish_set(folder, whole, runs, whole.at("format").get<std::string>() == "hdf5", stop);
  });
  result.commit();
  return beyond;
}

}  // namespace plenoflame::cli
