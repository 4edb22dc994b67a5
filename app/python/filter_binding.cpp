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
#include "light_field_filter.h"
#include "plenoflame/base/part_of_progress.h"
#include "plenoflame/lightfield/develop.h"
#include "plenoflame/lightfield/refocus.h"
#include "plenoflame/lightfield/views.h"
#include "runnable.h"
#include "values.h"

namespace plenoflame::python {
namespace {

namespace py = pybind11;
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
    const MicroImages& micro = micro_.get(taken_through(*input), settings.white_correction,
                                          part_of_progress(execution, 0, 0.5));
    output = extract_views(*input, micro, settings, part_of_progress(execution, 0.5, 0.5));
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
    const MicroImages& images = micro(optics, execution);
    output = refocus(*input, images, settings, part_of_progress(execution, 0.5, 0.5));
  }
  const MicroImages& micro(const TakenThrough& optics, const Execution& execution) {
    return micro_.get(optics, true, part_of_progress(execution, 0, 0.5));
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
    const MicroImages& images = micro(optics, execution);
    stack = focus_stack(*input, images, depths, settings, part_of_progress(execution, 0.5, 0.5));
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
  void run(const Execution& execution) override {
    figures = comparison_json(*input, *reference, channel, execution);
  }
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

py::array developed(DevelopFilter& filter) {
  auto& picture = filter.output.picture;
  const auto rows = static_cast<py::ssize_t>(picture.samples.size()) / picture.width;
  return given(std::move(picture.samples), {rows, picture.width});
}

/// All in focus, depth, confidence, and the pictures of all depths.
py::tuple stacked(FocusStackFilter& filter) {
  py::list planes;
  for (RefocusedImage& plane : filter.stack.planes) planes.append(given(std::move(plane.image)));
  return py::make_tuple(given(std::move(filter.stack.all_in_focus)),
                        given(std::move(filter.stack.depth)),
                        given(std::move(filter.stack.confidence)), planes);
}

void bind_develop(py::module_& module) {
  py::enum_<ToneCurve>(module, "ToneCurve")
      .value("linear", ToneCurve::linear)
      .value("display", ToneCurve::display);
  py::class_<DevelopFilter, Filter> develop(module, "Develop");
  attributes(develop, &DevelopFilter::spec, "saturation", &DevelopSpec::saturation, "bits",
             &DevelopSpec::bits, "curve", &DevelopSpec::curve);
  develop.def(py::init<>()).def_property_readonly("output", &developed);
}

void bind_views(py::module_& module) {
  py::enum_<ViewResampling>(module, "Resampling")
      .value("nearest", ViewResampling::nearest)
      .value("barycentric", ViewResampling::barycentric)
      .value("paper9", ViewResampling::paper9)
      .value("paper10", ViewResampling::paper10);
  py::class_<ViewsFilter, Filter> views(module, "Views");
  attributes(views, &ViewsFilter::settings, "grid", &ViewSettings::grid, "spread",
             &ViewSettings::spread, "resampling", &ViewSettings::resampling, "white_correction",
             &ViewSettings::white_correction);
  views.def(py::init<>()).def_property_readonly("output", [](ViewsFilter& f) {
    py::list list;
    for (View& view : f.output.views) list.append(given(std::move(view.image)));
    return py::make_tuple(list, given(std::move(f.sheet)));
  });
}

void bind_refocus(py::module_& module) {
  py::class_<RefocusFilter, Filter> refocus(module, "Refocus");
  attributes(refocus, &RefocusFilter::settings, "width", &RefocusSettings::width, "aperture",
             &RefocusSettings::aperture, "depth", &RefocusSettings::depth);
  refocus.def(py::init<>())
      .def_property_readonly("pixel", [](const RefocusFilter& f) { return f.output.pixel; })
      .def_property_readonly("corner",
                             [](const RefocusFilter& f) {
                               return py::make_tuple(f.output.corner.x, f.output.corner.y);
                             })
      .def_property_readonly("output",
                             [](RefocusFilter& f) { return given(std::move(f.output.image)); });
  py::class_<FocusStackFilter, RefocusFilter>(module, "FocusStack")
      .def(py::init<>())
      .def_readwrite("depths", &FocusStackFilter::depths)
      .def_property_readonly("output", &stacked);
}

void bind_export(py::module_& module) {
  py::class_<ExportFilter, Filter> files(module, "Export");
  attributes(files, &ExportFilter::request, "folder", &ExportRequest::folder, "format",
             &ExportRequest::format, "name", &ExportRequest::name, "grid", &ExportRequest::grid,
             "channels", &ExportRequest::channels);
  files.def(py::init<>()).def_property_readonly("output", [](const ExportFilter& f) {
    return py::make_tuple(f.result.files, f.result.notes);
  });
  module.def("export_formats", [] {
    std::vector<std::string> names;
    for (const ExportName& format : export_formats()) names.push_back(format.name);
    return names;
  });
}

}  // namespace

void bind_light_field_filters(py::module_& module) {
  py::class_<Filter, Runnable>(module, "Filter")
      .def_readwrite("input", &Filter::input)
      .def_readwrite("channel", &Filter::channel);
  bind_develop(module);
  bind_views(module);
  bind_refocus(module);
  bind_export(module);
  py::class_<ComparisonFilter, Filter>(module, "Comparison")
      .def(py::init<>())
      .def_readwrite("reference", &ComparisonFilter::reference)
      .def_readonly("figures", &ComparisonFilter::figures);
  py::class_<LightFieldReader, Runnable>(module, "LightFieldReader")
      .def(py::init<>())
      .def_readwrite("path", &LightFieldReader::path)
      .def_readonly("output", &LightFieldReader::output);
  py::class_<LightFieldWriter, Filter>(module, "LightFieldWriter")
      .def(py::init<>())
      .def_readwrite("path", &LightFieldWriter::path);
}

}  // namespace plenoflame::python
