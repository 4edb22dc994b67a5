/**
 * @class   vtkPlenoflameRayStream
 * @brief   the rays that make a picture, block by block
 *
 * Next() gives the rays of a window's pixels as tables of some ten thousand rays, which are traced
 * meanwhile by other threads; the sum of etendue x radiance over the rays of a pixel is its flux.
 * All rays of a pixel come in blocks of one tile (64 x 64 pixels), in an order that depends on
 * nothing but scene and settings; tiles come as they are ready.
 *
 * Columns: "pixel" (column, row), "microlens" (q, r), "type" (-1: no microlens), "replicate",
 * "status" (0 reached the scene, 1 vignetted, 2 total internal reflection, 3 missed a surface),
 * "ended_at" (surface; -1), "etendue" and "sampled_etendue" [m^2 sr], "origin" [m], "direction",
 * "t_near", "t_far" [m]; with Radiance also "radiance" [W/(m^2 sr)], a component per channel. Field
 * data: "anchor" [m] in the world, from which origins count; "tile", "path", and "channels", the
 * numbers of the scene's channels that "radiance" has.
 */
#ifndef vtkPlenoflameRayStream_h
#define vtkPlenoflameRayStream_h

#include "vtkObject.h"
#include "vtkPlenoflameModule.h"  // for export macro

#ifndef __VTK_WRAP__
#include <memory>
#endif

class vtkPlenoflameScene;
class vtkTable;

class VTKPLENOFLAME_EXPORT vtkPlenoflameRayStream : public vtkObject {
 public:
  static vtkPlenoflameRayStream* New();
  vtkTypeMacro(vtkPlenoflameRayStream, vtkObject);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * Begins with the first block of a scene. What is set afterwards counts for the next Start().
   * @return false after an error event
   */
  bool Start(vtkPlenoflameScene* scene);

  /**
   * The next block; nothing at the end, and after an error event.
   */
  VTK_NEWINSTANCE vtkTable* Next();

  /**
   * Whether Next() would not have to wait.
   */
  bool IsReady();

  /**
   * Ends before all blocks have come.
   */
  void Stop();

  ///@{
  /**
   * Rays per pixel and microlens that covers it (default: 64).
   */
  vtkSetClampMacro(Samples, int, 1, VTK_INT_MAX);
  vtkGetMacro(Samples, int);
  ///@}

  ///@{
  /**
   * Seed; -1 (default): the scene's.
   */
  vtkSetMacro(Seed, vtkTypeInt64);
  vtkGetMacro(Seed, vtkTypeInt64);
  ///@}

  ///@{
  /**
   * Part of the sensor: x, y, width, height from the top left; width 0 (default): all.
   */
  vtkSetVector4Macro(Window, int);
  vtkGetVector4Macro(Window, int);
  ///@}

  ///@{
  /**
   * Double precision (default: on): of the tracer and of the columns. Off: single.
   */
  vtkSetMacro(DoublePrecision, bool);
  vtkGetMacro(DoublePrecision, bool);
  vtkBooleanMacro(DoublePrecision, bool);
  ///@}

  ///@{
  /**
   * Whether pixels and microlenses that cannot see the scene are left out (default: on).
   */
  vtkSetMacro(Skip, bool);
  vtkGetMacro(Skip, bool);
  vtkBooleanMacro(Skip, bool);
  ///@}

  ///@{
  /**
   * Whether the radiance of each ray is found, too (default: off).
   */
  vtkSetMacro(Radiance, bool);
  vtkGetMacro(Radiance, bool);
  vtkBooleanMacro(Radiance, bool);
  ///@}

  ///@{
  /**
   * Rays of a block, about (default: 65536).
   */
  vtkSetClampMacro(RaysPerBlock, int, 1, 1 << 24);
  vtkGetMacro(RaysPerBlock, int);
  ///@}

  ///@{
  /**
   * Worker threads; 0 (default): one per processor. With one thread tiles come in their order.
   */
  vtkSetClampMacro(NumberOfThreads, int, 0, 1024);
  vtkGetMacro(NumberOfThreads, int);
  ///@}

 protected:
  vtkPlenoflameRayStream();
  ~vtkPlenoflameRayStream() override;

  int Samples = 64;
  vtkTypeInt64 Seed = -1;
  int Window[4] = {0, 0, 0, 0};
  bool DoublePrecision = true, Skip = true, Radiance = false;
  int RaysPerBlock = 65536, NumberOfThreads = 0;

 private:
  vtkPlenoflameRayStream(const vtkPlenoflameRayStream&) = delete;
  void operator=(const vtkPlenoflameRayStream&) = delete;

  struct Internals;
  std::unique_ptr<Internals> Internal;
};

#endif
