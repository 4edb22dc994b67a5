/**
 * @class   vtkPlenoflameCameraSource
 * @brief   the geometry of a scene's camera, in the world
 *
 * Input: a vtkPlenoflameScene. Output: a vtkMultiBlockDataSet with the blocks "lens surfaces",
 * "lens edges", "stop", "microlenses", "array plate" and "sensor", each a vtkPolyData (empty when
 * the camera has none, or the level of detail leaves it out). Cell data: "surface" (number from the
 * scene), "type" of the microlens or -1, "microlens" (q, r). The sensor has texture coordinates for
 * an image whose rows run upwards; the plate's texture is GetPlateTexture(), to be repeated.
 */
#ifndef vtkPlenoflameCameraSource_h
#define vtkPlenoflameCameraSource_h

#include "vtkMultiBlockDataSetAlgorithm.h"
#include "vtkNew.h"               // for the texture
#include "vtkPlenoflameModule.h"  // for export macro

class vtkImageData;

class VTKPLENOFLAME_EXPORT vtkPlenoflameCameraSource : public vtkMultiBlockDataSetAlgorithm {
 public:
  static vtkPlenoflameCameraSource* New();
  vtkTypeMacro(vtkPlenoflameCameraSource, vtkMultiBlockDataSetAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum LevelOfDetailType {
    AUTOMATIC = 0,        ///< all microlenses up to MaximumNumberOfMicrolenses, otherwise the plate
    ALL_MICROLENSES = 1,  ///< each with both surfaces
    WINDOW = 2,           ///< those in front of Window, and the plate
    PLATE = 3             ///< a rectangle with a texture
  };

  enum BlockType {
    LENS_SURFACES = 0,
    LENS_EDGES = 1,
    STOP = 2,
    MICROLENSES = 3,
    ARRAY_PLATE = 4,
    SENSOR = 5
  };

  ///@{
  /**
   * How the array is shown (default: AUTOMATIC).
   */
  vtkSetClampMacro(LevelOfDetail, int, AUTOMATIC, PLATE);
  vtkGetMacro(LevelOfDetail, int);
  ///@}

  ///@{
  /**
   * Above so many microlenses AUTOMATIC takes the plate (default: 3000).
   */
  vtkSetClampMacro(MaximumNumberOfMicrolenses, int, 0, VTK_INT_MAX);
  vtkGetMacro(MaximumNumberOfMicrolenses, int);
  ///@}

  ///@{
  /**
   * Part of the sensor for WINDOW: first column and row from the top left, width, height.
   */
  vtkSetVector4Macro(Window, int);
  vtkGetVector4Macro(Window, int);
  ///@}

  ///@{
  /**
   * Sectors of a surface of the main lens (default: 96), and of a microlens (default: 12).
   */
  vtkSetClampMacro(LensResolution, int, 3, 2048);
  vtkGetMacro(LensResolution, int);
  vtkSetClampMacro(MicrolensResolution, int, 3, 256);
  vtkGetMacro(MicrolensResolution, int);
  ///@}

  /**
   * What the plate repeats; call Update() first.
   */
  vtkImageData* GetPlateTexture();

  /**
   * Colour in which the module shows a microlens type, and its rays; -1: no microlens.
   */
  static void GetTypeColor(int type, double rgb[3]);

 protected:
  vtkPlenoflameCameraSource();
  ~vtkPlenoflameCameraSource() override;

  int FillInputPortInformation(int port, vtkInformation* information) override;
  int RequestData(vtkInformation* request, vtkInformationVector** inputs,
                  vtkInformationVector* outputs) override;

  int LevelOfDetail = AUTOMATIC;
  int MaximumNumberOfMicrolenses = 3000;
  int Window[4] = {0, 0, 0, 0};
  int LensResolution = 96, MicrolensResolution = 12;
  vtkNew<vtkImageData> PlateTexture;

 private:
  vtkPlenoflameCameraSource(const vtkPlenoflameCameraSource&) = delete;
  void operator=(const vtkPlenoflameCameraSource&) = delete;
};

#endif
