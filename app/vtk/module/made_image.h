#pragma once
#include <vtkNew.h>
#include <vtkType.h>

#include <functional>

class vtkAlgorithm;
class vtkImageData;
class vtkInformation;
class vtkInformationVector;

namespace plenoflame::pipeline {

/// An image whose size is known only when it has been made. VTK asks for the size first, so that
/// is when it is made; it is kept for the question that follows.
class MadeImage {
 public:
  MadeImage();
  ~MadeImage();

  /// For RequestInformation: makes the image, unless it is up to date. The port gets its size.
  /// @param make fills the image and returns whether it did
  /// @return 1, or 0 where it was not made
  int announce(vtkAlgorithm& algorithm, vtkInformation& port,
               const std::function<bool(vtkImageData&)>& make);
  /// For RequestData: the image at port `port`.
  void give(vtkInformationVector& outputs, int port = 0);

 private:
  vtkNew<vtkImageData> image_;
  vtkMTimeType time_ = 0;  ///< of the algorithm and its input when it was made
};

}  // namespace plenoflame::pipeline
