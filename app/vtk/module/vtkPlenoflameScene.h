/**
 * @class   vtkPlenoflameScene
 * @brief   a camera, its flames and how to render them
 *
 * The scene of a TOML file as a data object: it comes from a vtkPlenoflameSceneReader, or stands
 * alone and is given to other algorithms with SetInputDataObject(). A scene with several cameras is
 * about one of them, which SetCamera() chooses, for everything but its values and texts. Values are
 * read and set as text with units, by the paths of docs/reference/scene.md:
 * SetValue("camera.lens.surfaces[0].radius", "30 mm"). Change a scene that stands alone: what a
 * reader gave is replaced when it reads again.
 */
#ifndef vtkPlenoflameScene_h
#define vtkPlenoflameScene_h

#include "vtkDataObject.h"
#include "vtkPlenoflameModule.h"  // for export macro

class vtkImageData;

#ifndef __VTK_WRAP__
#include <memory>
#include <vector>

#include "plenoflame/scene/validate.h"

namespace plenoflame {
struct CompiledScene;
struct Execution;
struct Scene;
struct SceneDocument;
}  // namespace plenoflame
#endif

class VTKPLENOFLAME_EXPORT vtkPlenoflameScene : public vtkDataObject {
 public:
  static vtkPlenoflameScene* New();
  vtkTypeMacro(vtkPlenoflameScene, vtkDataObject);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Take the scene of a TOML file, or of text in the same form; `name` stands for the file in
   * messages and as the start of relative paths. The scene is checked as a whole. False after an
   * error event "file:line:column: ..."; the scene is then unchanged.
   */
  bool ReadFile(const std::string& path);
  bool ReadText(const std::string& text, const std::string& name);
  ///@}

  ///@{
  /**
   * The whole scene as TOML, presets resolved.
   */
  std::string GetText();
  bool WriteFile(const std::string& path);
  ///@}

  ///@{
  /**
   * A value by its path, as text with a unit ("100 um", "true", "1 m, 0 m, -29 mm"). SetValue gives
   * false after an error event (unknown path, missing unit, out of range); nothing is changed then.
   */
  std::string GetValue(const std::string& path);
  bool SetValue(const std::string& path, const std::string& text);
  ///@}

  /**
   * Keep an image (arrays temperature [K] and absorption [1/m], others as emission lines [W/m^3])
   * under a name that stands for a file: flames whose "file" is this name are made of it. False
   * after an error event. A copy of the scene keeps it, a file of the scene does not.
   */
  bool SetFlameImage(const std::string& name, vtkImageData* image, double ambient_temperature);

  ///@{
  /**
   * All paths that the scene has values for.
   */
  int GetNumberOfPaths();
  std::string GetPath(int i);
  ///@}

  ///@{
  /**
   * Lists of tables, such as "flames" or "camera.lens.surfaces". Size is -1 after an error event.
   */
  int GetListSize(const std::string& path);
  bool InsertListItem(const std::string& path, int position);
  bool RemoveListItem(const std::string& path, int position);
  ///@}

  /**
   * Check the scene as a whole: an error event for the first thing that is impossible, warning
   * events for what is probably not meant.
   */
  bool Validate();

  ///@{
  /**
   * Its cameras by their names; the one of a scene with a single camera may have none.
   */
  int GetNumberOfCameras();
  std::string GetCameraName(int i);
  ///@}

  ///@{
  /**
   * Which of them it is about: what is rendered, designed, traced. Empty (default): the only one;
   * where there are several, that is an error event of whatever needs one. SetCamera gives false
   * after an error event (no camera has that name). What cameras have in common is kept.
   */
  bool SetCamera(const std::string& name);
  std::string GetCamera();
  ///@}

  ///@{
  /**
   * Frames of flames that change with time (docs/user/time.md), as the camera takes them that it is
   * about, or the first; the last is below the first where there are none.
   */
  int GetFirstFrame();
  int GetLastFrame();
  ///@}

  ///@{
  /**
   * Make it the scene of one moment: at a time [s], or at the begin of a frame's exposure. Values
   * and text are then of that moment. False after an error event: nothing changes with time, or
   * that moment is before or beyond what is known, or its file is missing.
   */
  bool MoveToTime(double time);
  bool MoveToFrame(int frame);
  ///@}

  ///@{
  /**
   * Sensor: columns, rows, and the distance between pixels [m].
   */
  int GetNumberOfColumns();
  int GetNumberOfRows();
  double GetPixelPitch();
  ///@}

  ///@{
  /**
   * Channels of its images.
   */
  int GetNumberOfChannels();
  std::string GetChannelName(int i);
  ///@}

  ///@{
  /**
   * VTK's rules of data objects: both copies are deep, a scene is small.
   */
  void Initialize() override;
  void ShallowCopy(vtkDataObject* source) override;
  void DeepCopy(vtkDataObject* source) override;
  unsigned long GetActualMemorySize() override;
  ///@}

#ifndef __VTK_WRAP__
  /// For C++: the plain values.
  const plenoflame::Scene& GetScene() const;
  /// The same with the chosen camera alone. @throws plenoflame::InputError when none is chosen
  plenoflame::Scene GetSceneOfCamera() const;
  void SetScene(const plenoflame::Scene& scene);
  /// The same with the places of its keys in a file, for messages.
  void SetDocument(const plenoflame::SceneDocument& document);
  /// Camera solved, pupils traced, flames loaded; kept until the scene is modified.
  /// @param unsaid warnings that do not matter for what the caller does with it
  /// @throws plenoflame::Error
  std::shared_ptr<const plenoflame::CompiledScene> Compile(
      const plenoflame::Execution& execution,
      const std::vector<plenoflame::IssueCode>& unsaid = {});
#endif

 protected:
  vtkPlenoflameScene();
  ~vtkPlenoflameScene() override;

 private:
  vtkPlenoflameScene(const vtkPlenoflameScene&) = delete;
  void operator=(const vtkPlenoflameScene&) = delete;

  struct Internals;
  std::unique_ptr<Internals> Internal;
};

#endif
