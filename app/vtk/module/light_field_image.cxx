#include "light_field_image.h"

#include <vtkDataArray.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkStringArray.h>

#include <algorithm>
#include <array>
#include <cstdlib>

#include "plenoflame/base/error.h"

namespace plenoflame::pipeline {
namespace {

constexpr const char* kPrefix = "plenoflame.";

std::string full_name(const std::string& name) {
  return kPrefix + name;
}

/// The middle of the lower left pixel; that of the sensor's corner is (0.5, 0.5).
std::array<double, 3> origin_of(const PixelWindow& window, int sensor_height) {
  return {window.x + 0.5, sensor_height - window.y - window.height + 0.5, 0};
}

void add_texts(vtkFieldData& data, const std::string& name, const std::vector<std::string>& texts) {
  vtkNew<vtkStringArray> array;
  array->SetName(full_name(name).c_str());
  for (const std::string& text : texts) array->InsertNextValue(text);
  data.AddArray(array);
}

void add_numbers(vtkFieldData& data, const std::string& name, const std::vector<double>& numbers) {
  vtkNew<vtkDoubleArray> array;
  array->SetName(full_name(name).c_str());
  for (const double number : numbers) array->InsertNextValue(number);
  data.AddArray(array);
}

std::vector<std::string> texts_of(vtkFieldData& data, const std::string& name) {
  auto* const array = vtkStringArray::SafeDownCast(data.GetAbstractArray(full_name(name).c_str()));
  if (!array)
    throw InputError("the image is no light field: it has no field data '" + full_name(name) +
                     "'; light fields come from vtkPlenoflameLightFieldSource or "
                     "vtkPlenoflameLightFieldReader");
  std::vector<std::string> texts;
  for (vtkIdType i = 0; i < array->GetNumberOfValues(); ++i) texts.push_back(array->GetValue(i));
  return texts;
}

std::string text_of(vtkFieldData& data, const std::string& name) {
  const std::vector<std::string> texts = texts_of(data, name);
  return texts.empty() ? "" : texts.front();
}

std::vector<double> numbers_of(vtkFieldData& data, const std::string& name, vtkIdType count) {
  vtkDataArray* const array = data.GetArray(full_name(name).c_str());
  if (!array || array->GetNumberOfValues() < count)
    throw InputError("the image is no light field: it has no field data '" + full_name(name) + "'");
  std::vector<double> numbers;
  for (vtkIdType i = 0; i < array->GetNumberOfValues(); ++i)
    numbers.push_back(array->GetVariantValue(i).ToDouble());
  return numbers;
}

Image image_of(vtkImageData& in, const std::string& name, const PixelWindow& window) {
  vtkDataArray* const array = in.GetPointData()->GetArray(name.c_str());
  if (!array) throw InputError("the image has no point data '" + name + "'");
  Image image(window.width, window.height);
  if (array->GetNumberOfValues() != static_cast<vtkIdType>(image.pixels.size()))
    throw InputError("the image's point data '" + name + "' has " +
                     std::to_string(array->GetNumberOfValues()) + " values, its window " +
                     std::to_string(image.pixels.size()));
  const auto width = static_cast<std::size_t>(image.width),
             height = static_cast<std::size_t>(image.height);
  auto* const floats = vtkFloatArray::FastDownCast(array);
  for (std::size_t row = 0; row < height; ++row) {
    float* const to = image.pixels.data() + (height - 1 - row) * width;
    if (floats)
      std::copy_n(floats->GetPointer(static_cast<vtkIdType>(row * width)), width, to);
    else
      for (std::size_t x = 0; x < width; ++x)
        to[x] = static_cast<float>(array->GetTuple1(static_cast<vtkIdType>(row * width + x)));
  }
  return image;
}

/// Adds a further picture of the same size.
void add_image(const Image& in, const std::string& name, vtkImageData& out) {
  vtkNew<vtkFloatArray> array;
  array->SetName(name.c_str());
  array->SetNumberOfValues(static_cast<vtkIdType>(in.pixels.size()));
  float* const to = array->GetPointer(0);
  const auto width = static_cast<std::size_t>(in.width),
             height = static_cast<std::size_t>(in.height);
  for (std::size_t row = 0; row < height; ++row)
    std::copy_n(in.pixels.data() + row * width, width, to + (height - 1 - row) * width);
  out.GetPointData()->AddArray(array);
}

}  // namespace

void image_to_vtk(const Image& in, const char* name, vtkImageData& out) {
  out.Initialize();
  out.SetDimensions(in.width, in.height, 1);
  out.SetSpacing(1, 1, 1);
  out.SetOrigin(0.5, 0.5, 0);
  add_image(in, name, out);
  out.GetPointData()->SetActiveScalars(name);
}

void announce_light_field(const PixelWindow& window, int sensor_height, vtkInformation& port) {
  const std::array<int, 6> extent{0, window.width - 1, 0, window.height - 1, 0, 0};
  const std::array<double, 3> origin = origin_of(window, sensor_height);
  port.Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent.data(), 6);
  port.Set(vtkDataObject::ORIGIN(), origin.data(), 3);
  vtkDataObject::SetPointDataActiveScalarInfo(&port, VTK_FLOAT, 1);
}

void light_field_to_image(const LightField& field, vtkImageData& image) {
  const PixelWindow& w = field.window;
  image.Initialize();
  image.SetDimensions(w.width, w.height, 1);
  image.SetSpacing(1, 1, 1);
  image.SetOrigin(origin_of(w, field.sensor_height).data());
  std::vector<std::string> channels, layers;
  for (const LightFieldChannel& channel : field.channels) {
    channels.push_back(channel.name);
    add_image(channel.flux, channel.name, image);
    if (!channel.standard_error.empty())
      add_image(channel.standard_error, channel.name + ".error", image);
  }
  for (const auto& [name, layer] : field.layers) {
    layers.push_back(name);
    add_image(layer, name, image);
  }
  if (!channels.empty()) image.GetPointData()->SetActiveScalars(channels.front().c_str());
  vtkFieldData& data = *image.GetFieldData();
  add_texts(data, "channels", channels);
  add_texts(data, "layers", layers);
  add_texts(data, "scene", {field.scene_text});
  add_texts(data, "estimator", {field.estimator});
  add_texts(data, "seed", {std::to_string(field.seed)});
  add_texts(data, "version", {field.version});
  add_texts(data, "unit", {field.unit});
  add_numbers(data, "sensor",
              {static_cast<double>(field.sensor_width), static_cast<double>(field.sensor_height)});
  add_numbers(data, "window",
              {static_cast<double>(w.x), static_cast<double>(w.y), static_cast<double>(w.width),
               static_cast<double>(w.height)});
  add_numbers(data, "samples", {field.samples});
  add_numbers(data, "complete", {field.complete ? 1.0 : 0.0});
  std::vector<std::string> names;
  std::vector<double> values;
  for (const auto& [name, value] : field.numbers) {
    names.push_back(name);
    values.push_back(value);
  }
  add_texts(data, "number_names", names);
  add_numbers(data, "numbers", values);
  names.clear();
  std::vector<std::string> texts;
  for (const auto& [name, text] : field.texts) {
    names.push_back(name);
    texts.push_back(text);
  }
  add_texts(data, "text_names", names);
  add_texts(data, "texts", texts);
}

LightField image_to_light_field(vtkImageData& image) {
  vtkFieldData& data = *image.GetFieldData();
  LightField field;
  const std::vector<std::string> channels = texts_of(data, "channels");
  const std::vector<double> sensor = numbers_of(data, "sensor", 2);
  const std::vector<double> window = numbers_of(data, "window", 4);
  field.sensor_width = static_cast<int>(sensor[0]);
  field.sensor_height = static_cast<int>(sensor[1]);
  field.window = {static_cast<int>(window[0]), static_cast<int>(window[1]),
                  static_cast<int>(window[2]), static_cast<int>(window[3])};
  const std::vector<int> size{image.GetDimensions()[0], image.GetDimensions()[1]};
  if (size[0] != field.window.width || size[1] != field.window.height)
    throw InputError("the image has " + std::to_string(size[0]) + " x " + std::to_string(size[1]) +
                     " points, but its field data says " + std::to_string(field.window.width) +
                     " x " + std::to_string(field.window.height));
  for (const std::string& name : channels) {
    LightFieldChannel channel{name, image_of(image, name, field.window), {}};
    if (image.GetPointData()->HasArray((name + ".error").c_str()))
      channel.standard_error = image_of(image, name + ".error", field.window);
    field.channels.push_back(std::move(channel));
  }
  for (const std::string& name : texts_of(data, "layers"))
    field.layers[name] = image_of(image, name, field.window);
  field.scene_text = text_of(data, "scene");
  field.estimator = text_of(data, "estimator");
  field.seed = std::strtoull(text_of(data, "seed").c_str(), nullptr, 10);
  field.version = text_of(data, "version");
  field.unit = text_of(data, "unit");
  field.samples = numbers_of(data, "samples", 1)[0];
  field.complete = numbers_of(data, "complete", 1)[0] != 0;
  const std::vector<std::string> names = texts_of(data, "number_names");
  const std::vector<double> values =
      numbers_of(data, "numbers", static_cast<vtkIdType>(names.size()));
  for (std::size_t i = 0; i < names.size(); ++i) field.numbers[names[i]] = values[i];
  if (!data.HasArray(full_name("text_names").c_str())) return field;  // of an older file
  const std::vector<std::string> text_names = texts_of(data, "text_names");
  const std::vector<std::string> texts = texts_of(data, "texts");
  if (texts.size() != text_names.size())
    throw InputError("the image is no light field: it has " + std::to_string(text_names.size()) +
                     " names of texts, but " + std::to_string(texts.size()) + " texts");
  for (std::size_t i = 0; i < texts.size(); ++i) field.texts[text_names[i]] = texts[i];
  return field;
}

}  // namespace plenoflame::pipeline
