#include "raw_bricks.h"

#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>

#include <array>
#include <bit>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"

namespace plenoflame::simulation {
namespace {

template <class Number>
std::array<Number, 3> three(const nlohmann::json& json, const char* key, const std::string& path) {
  if (!json.contains(key) || !json[key].is_array() || json[key].size() != 3 ||
      !json[key][0].is_number() || !json[key][1].is_number() || !json[key][2].is_number())
    throw InputError("'" + path + "': \"" + key + "\" must be a list of three numbers");
  return {json[key][0].get<Number>(), json[key][1].get<Number>(), json[key][2].get<Number>()};
}

}  // namespace

vtkSmartPointer<vtkDataSet> read_raw_bricks(const std::string& path) {
  const nlohmann::json json = nlohmann::json::parse(read_file(path), nullptr, false);
  if (json.is_discarded()) throw InputError("'" + path + "' is no JSON");
  const auto size = three<int>(json, "dimensions", path);
  const auto spacing = three<double>(json, "spacing_m", path);
  const auto origin = three<double>(json, "origin_m", path);
  for (std::size_t k = 0; k < 3; ++k)
    if (size[k] < 2 || size[k] > 4096 || !(spacing[k] > 0))
      throw InputError("'" + path + "': dimensions must be 2 to 4096 and spacings above 0");
  if (!json.contains("arrays") || !json["arrays"].is_object() || json["arrays"].empty())
    throw InputError("'" + path + "': \"arrays\" must name at least one file, {\"T\": \"T.raw\"}");
  const auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(size.data());
  image->SetSpacing(spacing.data());
  image->SetOrigin(origin.data());
  const std::size_t count = static_cast<std::size_t>(image->GetNumberOfPoints());
  for (const auto& [name, file] : json["arrays"].items()) {
    if (!file.is_string())
      throw InputError("'" + path + "': the file of \"" + name + "\" is not given as text");
    const std::string full =
        (std::filesystem::path(path).parent_path() / file.get<std::string>()).string();
    const std::string bytes = read_file(full);
    if (bytes.size() != count * sizeof(float))
      throw InputError("'" + full + "' has " + std::to_string(bytes.size()) + " bytes; " +
                       std::to_string(count) + " float32 values are " +
                       std::to_string(count * sizeof(float)));
    vtkNew<vtkFloatArray> array;
    array->SetName(name.c_str());
    array->SetNumberOfValues(image->GetNumberOfPoints());
    static_assert(std::endian::native == std::endian::little);
    std::memcpy(array->GetPointer(0), bytes.data(), bytes.size());
    image->GetPointData()->AddArray(array);
  }
  return image;
}

}  // namespace plenoflame::simulation
