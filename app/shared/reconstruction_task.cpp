#include "reconstruction_task.h"

#include <utility>

#include "plenoflame/base/error.h"

namespace plenoflame {

void ReconstructionTask::set_option(const std::string& name, const std::string& text) {
  plenoflame::set_option(request_, name, text);
}

void ReconstructionTask::add_camera(Compile compile, const std::string& camera, LightField picture,
                                    const std::string& what) {
  compile_.push_back(std::move(compile));
  camera_names_.push_back(camera.empty() ? "the scene" : "camera \"" + camera + "\" of the scene");
  pictures_.push_back(std::move(picture));
  names_.push_back(what);
}

void ReconstructionTask::set_earlier(const std::string& use, const std::string& field,
                                     std::vector<double> values) {
  if (use != "start" && use != "prior")
    throw UsageError("an earlier result is a start or a prior, not " + use);
  std::shared_ptr<EarlierResult>& result = use == "start" ? start_ : prior_;
  if (!result) result = std::make_shared<EarlierResult>();
  std::vector<double>* const to = field == "emission"      ? &result->emission
                                  : field == "temperature" ? &result->temperature
                                  : field == "absorption"  ? &result->absorption
                                                           : nullptr;
  if (!to) throw UsageError("an earlier result has no field " + field);
  *to = std::move(values);
}

void ReconstructionTask::run(const Execution& execution, const Watch& watch) {
  result_.reset();
  reconstructor_.reset();
  report_ = {};
  request_.start_values = start_;
  request_.prior_values = prior_;
  static_cast<void>(reconstruction_settings(request_, 1));  // before any work
  if (compile_.empty()) throw UsageError("a reconstruction needs a camera and its picture");
  std::vector<ReconstructCamera> cameras;
  for (std::size_t v = 0; v < compile_.size(); ++v)
    cameras.push_back({compile_[v](execution), camera_names_[v]});
  cameras_ = reconstruct_cameras(request_, std::move(cameras), pictures_.front(), names_);
  const FrameMeasurements measured = measure_frame(request_, cameras_, pictures_, names_);
  reconstructor_ = std::make_unique<Reconstructor>(request_, cameras_, measured, execution);
  warn_of_pictures(measured, names_, execution);
  std::function<void(const ReconstructionState&)> told;
  if (watch)
    told = [&](const ReconstructionState& state) { watch(state, reconstructor_->unknowns()); };
  ReconstructResult result = reconstructor_->frame(measured, execution, told);
  report_ = reconstructor_->report(result, "", execution);
  result_ = std::move(result);
}

std::string ReconstructionTask::report_text() const {
  std::string text;
  for (const auto& [label, value] : report_.lines()) text += label + ": " + value + '\n';
  return text;
}

std::vector<VoxelField> ReconstructionTask::voxels(IndexBox& box) const {
  std::vector<VoxelField> fields;
  for (const ReconstructedField& field : reconstructed_fields(result())) {
    fields.push_back(on_voxels(field, unknowns()));
    box.add(stored_box(fields.back()));
  }
  return fields;
}

void ReconstructionTask::write(const std::string& path) const {
  if (!has_result()) throw UsageError("there is no result to write");
  write_estimate(path, result(), unknowns());
}

}  // namespace plenoflame
