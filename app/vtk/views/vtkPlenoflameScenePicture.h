/**
 * @class   vtkPlenoflameScenePicture
 * @brief   a picture of a scene: flame, camera, rays
 *
 * Shows the flame as a volume coloured by temperature, solid surfaces, the lens' surfaces with
 * their true shape, the array and the sensor, and rays, in one of four views; the whole scene has
 * insets of the camera and of the array, since these are smaller by orders of magnitude. Every view
 * has clipping planes of its own.
 *
 * Without a window: RenderToImage() and WritePNG(). For an application: AddTo() puts the props into
 * a renderer of its own. Neither Qt nor a window is needed, but OpenGL is: see CanRender().
 */
#ifndef vtkPlenoflameScenePicture_h
#define vtkPlenoflameScenePicture_h

#include <memory>  // for std::unique_ptr
#include <string>  // for messages
#include <vector>  // for places

#include "vtkObject.h"
#include "vtkPlenoflameViewsModule.h"  // for export macro
#include "vtkSmartPointer.h"           // for members

class vtkImageData;
class vtkPlenoflameScene;
class vtkPolyData;
class vtkRenderer;
// Written apart: VTK's wrapping tools do not know the short form.
namespace plenoflame {
struct Vec3;
namespace views {
struct SolidSurfaces;
}
}  // namespace plenoflame

class VTKPLENOFLAMEVIEWS_EXPORT vtkPlenoflameScenePicture : public vtkObject {
 public:
  static vtkPlenoflameScenePicture* New();
  vtkTypeMacro(vtkPlenoflameScenePicture, vtkObject);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum ViewType {
    WHOLE_SCENE = 0,  ///< flame and camera from the side
    CAMERA = 1,       ///< main lens to sensor
    ARRAY = 2,        ///< a few microlenses and the pixels behind them
    FLAME = 3         ///< flame and solid bodies as large as they fit
  };
  enum RayColorType { BY_TYPE = 0, BY_STATUS = 1 };

  ///@{
  /**
   * What is shown. Of a scene with several cameras all are in the views of the whole scene; the
   * views of one are of that which the scene names (vtkPlenoflameScene::SetCamera), or the first.
   */
  void SetScene(vtkPlenoflameScene* scene);
  vtkPlenoflameScene* GetScene();
  ///@}

  ///@{
  /**
   * Ray paths (vtkPlenoflameRayPathSource, or a .vtp file); none by default.
   */
  void SetRays(vtkPolyData* rays);
  vtkPolyData* GetRays();
  ///@}

  ///@{
  /**
   * The light field on the sensor (vtkPlenoflameLightFieldSource, ...Reader); none by default.
   */
  void SetSensorImage(vtkImageData* image);
  vtkImageData* GetSensorImage();
  ///@}

  ///@{
  /**
   * Where to look from (default: WHOLE_SCENE).
   */
  vtkSetClampMacro(View, int, WHOLE_SCENE, FLAME);
  vtkGetMacro(View, int);
  ///@}

  ///@{
  /**
   * Rays by the type of their microlens (default), or by how they ended.
   */
  vtkSetClampMacro(RayColoring, int, BY_TYPE, BY_STATUS);
  vtkGetMacro(RayColoring, int);
  ///@}

  ///@{
  /**
   * The pixel in the middle of ARRAY, column and row from the top left; -1 (default): that of the
   * first ray, otherwise the sensor's middle.
   */
  vtkSetVector2Macro(Pixel, int);
  vtkGetVector2Macro(Pixel, int);
  ///@}

  ///@{
  /**
   * Size of the picture in pixels (default: 1200 x 800).
   */
  vtkSetVector2Macro(Size, int);
  vtkGetVector2Macro(Size, int);
  ///@}

  ///@{
  /**
   * Points along the flame's longest side (default: 96).
   */
  vtkSetClampMacro(FlameResolution, int, 2, 1024);
  vtkGetMacro(FlameResolution, int);
  ///@}

  ///@{
  /**
   * Whether the flame, the solid surfaces, the insets, and axes with lengths are shown (default:
   * on).
   */
  vtkSetMacro(ShowFlame, bool);
  vtkGetMacro(ShowFlame, bool);
  vtkBooleanMacro(ShowFlame, bool);
  vtkSetMacro(ShowSurfaces, bool);
  vtkGetMacro(ShowSurfaces, bool);
  vtkBooleanMacro(ShowSurfaces, bool);
  vtkSetMacro(ShowInsets, bool);
  vtkGetMacro(ShowInsets, bool);
  vtkBooleanMacro(ShowInsets, bool);
  vtkSetMacro(ShowAxes, bool);
  vtkGetMacro(ShowAxes, bool);
  vtkBooleanMacro(ShowAxes, bool);
  ///@}

  /**
   * Put the props of a view into a renderer and point its camera. False after an error event.
   */
  bool AddTo(vtkRenderer* renderer);

  /**
   * The picture, as large as Size; null after an error event. It is the caller's until the next
   * one.
   */
  vtkImageData* RenderToImage();

  /**
   * Render and write; a file that is there is replaced when the new one is complete.
   */
  bool WritePNG(const std::string& path);

  /**
   * Whether pictures can be made here; otherwise the reason, with what to do about it. VTK itself
   * would end the program.
   */
  static bool CanRender();
  static std::string GetWhyNot();

 protected:
  vtkPlenoflameScenePicture();
  ~vtkPlenoflameScenePicture() override;

  int View = WHOLE_SCENE, RayColoring = BY_TYPE;
  int Pixel[2] = {-1, -1};
  int Size[2] = {1200, 800};
  int FlameResolution = 96;
  bool ShowFlame = true, ShowSurfaces = true, ShowInsets = true, ShowAxes = true;
  vtkSmartPointer<vtkPlenoflameScene> Scene;
  vtkSmartPointer<vtkPlenoflameScene> OfCamera;  ///< the same, a camera chosen; while drawing
  vtkSmartPointer<vtkPolyData> Rays;
  vtkSmartPointer<vtkImageData> SensorImage, Picture;

 private:
  vtkPlenoflameScenePicture(const vtkPlenoflameScenePicture&) = delete;
  void operator=(const vtkPlenoflameScenePicture&) = delete;

  bool AddOtherCameras(vtkRenderer* renderer, int font_size, std::vector<plenoflame::Vec3>& points);
  bool AddView(vtkRenderer* renderer, int view, bool inset, vtkImageData* flame,
               const plenoflame::views::SolidSurfaces& surfaces);
  std::unique_ptr<plenoflame::views::SolidSurfaces> Surfaces(vtkImageData* flame);
  vtkSmartPointer<vtkImageData> Flame();
  vtkSmartPointer<vtkPlenoflameScene> WithCamera();
};

#endif
