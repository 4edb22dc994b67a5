#include "widgets/flame/flame_opacity.h"

#include <vtkAbstractVolumeMapper.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPiecewiseFunction.h>
#include <vtkPointData.h>
#include <vtkVolume.h>
#include <vtkVolumeProperty.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "model/flame_glow.h"

namespace plenoflame::desktop {

void apply_opacity(const FlameLook& look, double cold, double hot, vtkVolume& volume) {
  vtkPiecewiseFunction* const old = volume.GetProperty()->GetScalarOpacity();
  vtkNew<vtkPiecewiseFunction> opacity;
  for (int i = 0; i < old->GetSize(); ++i) {
    std::array<double, 4> node{};
    old->GetNodeValue(i, node.data());
    // Optical thickness is what scales.
    opacity->AddPoint(node[0], 1 - std::pow(std::max(0.0, 1 - node[1]), look.density));
  }
  volume.GetProperty()->SetScalarOpacity(opacity);
  const auto& points = look.points;
  if (std::all_of(points.begin(), points.end(), [](const auto& p) { return p.opacity == 1; }))
    return;
  auto* const image = vtkImageData::SafeDownCast(volume.GetMapper()->GetDataSetInput());
  auto* const both =
      image ? vtkFloatArray::SafeDownCast(image->GetPointData()->GetScalars()) : nullptr;
  if (!both || both->GetNumberOfComponents() != 2) return;
  constexpr int kEntries = 512;
  std::array<float, kEntries> table{};
  for (int i = 0; i < kEntries; ++i)
    table[static_cast<std::size_t>(i)] =
        static_cast<float>(opacity_at(points, static_cast<double>(i) / (kEntries - 1)));
  const double scale = hot > cold ? (kEntries - 1) / (hot - cold) : 0;
  for (vtkIdType i = 0; i < both->GetNumberOfTuples(); ++i) {
    const double t = (static_cast<double>(both->GetTypedComponent(i, 0)) - cold) * scale;
    const auto entry = static_cast<std::size_t>(std::clamp(t + 0.5, 0.0, kEntries - 1.0));
    both->SetTypedComponent(i, 1, both->GetTypedComponent(i, 1) * table[entry]);
  }
  both->Modified();
}

void show_glow(const Medium& medium, vtkImageData& flame, const Execution& execution) {
  auto* const density = vtkFloatArray::SafeDownCast(flame.GetPointData()->GetArray("absorption"));
  if (!density || density->GetRange()[1] > 0) return;
  const std::array<int, 3> count{flame.GetDimensions()[0], flame.GetDimensions()[1],
                                 flame.GetDimensions()[2]};
  parallel_for(execution, static_cast<std::size_t>(count[2]), [&](std::size_t layer, int) {
    const vtkIdType area = static_cast<vtkIdType>(count[0]) * count[1],
                    first = static_cast<vtkIdType>(layer) * area;
    for (vtkIdType i = first; i < first + area; ++i) {
      std::array<double, 3> p{};
      flame.GetPoint(i, p.data());
      density->SetValue(i, static_cast<float>(glow(medium, {p[0], p[1], p[2]})));
    }
  });
}

}  // namespace plenoflame::desktop
