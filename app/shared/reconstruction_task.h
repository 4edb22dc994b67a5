#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plenoflame/image/light_field.h"
#include "reconstructor.h"
#include "voxel_arrays.h"

namespace plenoflame {

/// A reconstruction of one frame that is set up step by step and run. It then gives its result,
/// which both halves of the Python package show.
class ReconstructionTask {
 public:
  /// @param names as its caller writes settings
  explicit ReconstructionTask(SettingNames names) { request_.unknowns.names = names; }
  using Compile = std::function<std::shared_ptr<const CompiledScene>(const Execution&)>;

  /// As set_option() of ReconstructRequest.
  void set_option(const std::string& name, const std::string& text);
  /// @param camera its name, which may be empty @param what names the picture in messages
  void add_camera(Compile compile, const std::string& camera, LightField picture,
                  const std::string& what);
  std::size_t cameras() const { return compile_.size(); }
  /// A field of an earlier result at the same unknowns, in place of a file.
  /// @param use "start" or "prior" @param field "emission", "temperature" or "absorption"
  /// @throws UsageError
  void set_earlier(const std::string& use, const std::string& field, std::vector<double> values);

  /// Uses rows that were made with the same settings. They must outlive the runs.
  void set_built(const BuiltRows& built) { request_.built = built; }

  /// Called with each state of the run, by the reconstructing thread.
  using Watch = std::function<void(const ReconstructionState&, const Unknowns&)>;
  /// @param watch may be empty @throws as Reconstructor; there is no result then
  void run(const Execution& execution, const Watch& watch = {});

  bool has_result() const { return result_.has_value(); }
  /// With a result only.
  const ReconstructResult& result() const { return *result_; }
  const Unknowns& unknowns() const { return reconstructor_->unknowns(); }
  /// With a result: the scene's flames at the unknowns, if "truth" was set; else null.
  const FlameTruth* truth() const { return reconstructor_->truth(); }
  const Report& report() const { return report_; }
  /// Its lines, "label: text".
  std::string report_text() const;
  /// All fields on voxels of one lattice. @param box gets that where any is not 0
  std::vector<VoxelField> voxels(IndexBox& box) const;
  /// Writes the grids. @throws UsageError without a result, FileError
  void write(const std::string& path) const;

 private:
  ReconstructRequest request_;
  std::shared_ptr<EarlierResult> start_, prior_;
  std::vector<Compile> compile_;
  std::vector<std::string> names_, camera_names_;
  std::vector<LightField> pictures_;
  ReconstructCameras cameras_;
  std::unique_ptr<Reconstructor> reconstructor_;
  std::optional<ReconstructResult> result_;
  Report report_;
};

}  // namespace plenoflame
