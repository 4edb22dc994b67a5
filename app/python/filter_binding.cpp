#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "arrays.h"
#include "export_folder.h"
#include "figures_json.h"
#include "light_field_camera.h"
#include "plenoflame/lightfield/develop.h"
#include "plenoflame/lightfield/refocus.h"
#include "plenoflame/lightfield/views.h"
#include "runnable.h"

namespace plenoflame::python {
namespace {

namespace py = pybind11;
using Field = std::shared_ptr<LightField>;

/// Makes something of one light field.
class Filter : public Runnable {
 public:
  Field input;
  std::string channel;
};

class DevelopFilter : public Filter {
 public:
  void run(const Execution&) override { output = develop(*input, spec, channel); }
  DevelopSpec spec;
  DevelopedImage output;
};

class ViewsFilter : public Filter {
 public:
  void run(const Execution& execution) override {
    settings.channel = channel;
    output = extract_views(*input,
                           micro_.get(taken_through(*input), settings.white_correction, execution),
                           settings, execution);
    sheet = contact_sheet(output);
  }
  ViewSettings settings;
  Views output;
  Image sheet;

 private:
  pipeline::MicroImageCache micro_;
};

class RefocusFilter : public Filter {
 public:
  void run(const Execution& execution) override {
    const TakenThrough optics = taken_through(*input);
    check_refocus_depth(Camera(optics.camera), settings.depth);
    settings.channel = channel;
    output = refocus(*input, micro(optics, execution), settings, execution);
  }
  const MicroImages& micro(const TakenThrough& optics, const Execution& execution) {
    return micro_.get(optics, true, execution);
  }
  RefocusSettings settings;
  RefocusedImage output;

 private:
  pipeline::MicroImageCache micro_;
};

class FocusStackFilter : public RefocusFilter {
 public:
  void run(const Execution& execution) override {
    const TakenThrough optics = taken_through(*input);
    const Camera checked(optics.camera);
    for (const double depth : depths) check_refocus_depth(checked, depth);
    settings.channel = channel;
    stack = focus_stack(*input, micro(optics, execution), depths, settings, execution);
  }
  std::vector<double> depths;
  FocusStack stack;
};

class ExportFilter : public Filter {
 public:
  void run(const Execution& execution) override {
    request.channel = channel;
    result = export_to_folder(*input, request, execution);
  }
  ExportRequest request;
  ExportResult result;
};

class ComparisonFilter : public Filter {
 public:
  void run(const Execution&) override { figures = comparison_json(*input, *reference, channel); }
  Field reference;
  std::string figures;
};

class LightFieldReader : public Runnable {
 public:
  void run(const Execution& execution) override {
    output = std::make_shared<LightField>(read_light_field(path, execution.stop));
  }
  std::string path;
  Field output;
};

class LightFieldWriter : public Filter {
 public:
  void run(const Execution& execution) override { write_light_field(path, *input, execution.stop); }
  std::string path;
};

py::dict developed(DevelopFilter& filter) {
  py::dict out;
  const auto& picture = filter.output.picture;
  const auto rows = static_cast<py::ssize_t>(picture.samples.size()) / picture.width;
  out["digital_number"] = given(std::move(filter.output.picture.samples), {rows, picture.width});
  return out;
}

py::dict stacked(FocusStackFilter& filter) {
  py::dict out;
  out["all_in_focus"] = given(std::move(filter.stack.all_in_focus));
  out["depth"] = given(std::move(filter.stack.depth));
  out["confidence"] = given(std::move(filter.stack.confidence));
  std::size_t number = 0;
  for (RefocusedImage& plane : filter.stack.planes) {
    std::array<char, 24> name{};
    std::snprintf(name.data(), name.size(), "plane_%04zu", number++);
    out[name.data()] = given(std::move(plane.image));
  }
  return out;
}

void bind_develop(py::module_& module) {
  py::class_<DevelopFilter, Filter>(module, "Develop")
      .def(py::init<>())
      .def("SetSaturation", [](DevelopFilter& f, double value) { f.spec.saturation = value; })
      .def("SetBits", [](DevelopFilter& f, int bits) { f.spec.bits = bits; })
      .def("SetCurve",
           [](DevelopFilter& f, int curve) {
             f.spec.curve = curve == 0 ? ToneCurve::linear : ToneCurve::display;
           })
      .def("GetOutput", &developed);
}

void bind_views(py::module_& module) {
  py::class_<ViewsFilter, Filter>(module, "Views")
      .def(py::init<>())
      .def("SetGrid", [](ViewsFilter& f, int grid) { f.settings.grid = grid; })
      .def("SetSpread", [](ViewsFilter& f, double spread) { f.settings.spread = spread; })
      .def("SetResampling",
           [](ViewsFilter& f, int kind) {
             constexpr std::array kinds{ViewResampling::nearest, ViewResampling::barycentric,
                                        ViewResampling::paper9, ViewResampling::paper10};
             f.settings.resampling = kinds.at(static_cast<std::size_t>(kind));
           })
      .def("SetWhiteCorrection",
           [](ViewsFilter& f, bool white) { f.settings.white_correction = white; })
      .def("GetViews", [](ViewsFilter& f) {
        py::list views;
        for (View& view : f.output.views) views.append(given(std::move(view.image)));
        return py::make_tuple(views, given(std::move(f.sheet)));
      });
}

void bind_refocus(py::module_& module) {
  py::class_<RefocusFilter, Filter>(module, "Refocus")
      .def(py::init<>())
      .def("SetWidth", [](RefocusFilter& f, int width) { f.settings.width = width; })
      .def("SetAperture", [](RefocusFilter& f, double aperture) { f.settings.aperture = aperture; })
      .def("SetDepth", [](RefocusFilter& f, double depth) { f.settings.depth = depth; })
      .def("GetPixelSize", [](const RefocusFilter& f) { return f.output.pixel; })
      .def("GetCorner",
           [](const RefocusFilter& f) {
             return py::make_tuple(f.output.corner.x, f.output.corner.y);
           })
      .def("GetOutput", [](RefocusFilter& f) {
        py::dict out;
        out["radiance"] = given(std::move(f.output.image));
        return out;
      });
  py::class_<FocusStackFilter, RefocusFilter>(module, "FocusStack")
      .def(py::init<>())
      .def("RemoveAllDepths", [](FocusStackFilter& f) { f.depths.clear(); })
      .def("AddDepth", [](FocusStackFilter& f, double depth) { f.depths.push_back(depth); })
      .def("GetOutput", &stacked);
}

void bind_export(py::module_& module) {
  py::class_<ExportFilter, Filter>(module, "Export")
      .def(py::init<>())
      .def("SetFolder", [](ExportFilter& f, const std::string& v) { f.request.folder = v; })
      .def("SetFormat", [](ExportFilter& f, const std::string& v) { f.request.format = v; })
      .def("SetStem", [](ExportFilter& f, const std::string& v) { f.request.name = v; })
      .def("SetGrid", [](ExportFilter& f, int grid) { f.request.grid = grid; })
      .def("SetChannels", [](ExportFilter& f, const std::string& v) { f.request.channels = v; })
      .def("GetNumberOfFiles", [](const ExportFilter& f) { return f.result.files.size(); })
      .def("GetWrittenFile",
           [](const ExportFilter& f, std::size_t i) { return f.result.files.at(i); })
      .def("GetNumberOfNotes", [](const ExportFilter& f) { return f.result.notes.size(); })
      .def("GetNote", [](const ExportFilter& f, std::size_t i) { return f.result.notes.at(i); })
      .def_static("GetNumberOfFormats", [] { return export_formats().size(); })
      .def_static("GetFormatName", [](std::size_t i) { return export_formats().at(i).name; });
}

}  // namespace

void bind_light_field_filters(py::module_& module) {
  py::class_<Filter, Runnable>(module, "Filter")
      .def("SetInputData", [](Filter& f, Field field) { f.input = std::move(field); })
      .def("SetChannel", [](Filter& f, const std::string& channel) { f.channel = channel; });
  bind_develop(module);
  bind_views(module);
  bind_refocus(module);
  bind_export(module);
  py::class_<ComparisonFilter, Filter>(module, "Comparison")
      .def(py::init<>())
      .def("SetInputData",
           [](ComparisonFilter& f, int port, Field field) {
             (port == 0 ? f.input : f.reference) = std::move(field);
           })
      .def("GetFiguresAsJson", [](const ComparisonFilter& f) { return f.figures; });
  py::class_<LightFieldReader, Runnable>(module, "LightFieldReader")
      .def(py::init<>())
      .def("SetFileName", [](LightFieldReader& r, const std::string& path) { r.path = path; })
      .def("GetOutput", [](const LightFieldReader& r) { return r.output; });
  py::class_<LightFieldWriter, Filter>(module, "LightFieldWriter")
      .def(py::init<>())
      .def("SetFileName", [](LightFieldWriter& w, const std::string& path) { w.path = path; });
}

}  // namespace plenoflame::python
