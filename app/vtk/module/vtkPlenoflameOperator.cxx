#include "vtkPlenoflameOperator.h"

#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkIntArray.h>
#include <vtkObjectFactory.h>
#include <vtkSmartPointer.h>
#include <vtkTypeInt64Array.h>

#include <span>
#include <utility>
#include <vector>

#include "operator_problem.h"
#include "pipeline_run.h"
#include "plenoflame/base/error.h"
#include "shared_array.h"
#include "vtkPlenoflameScene.h"

namespace pipeline = plenoflame::pipeline;

struct vtkPlenoflameOperator::Internals {
  plenoflame::OperatorRequest Request;
  std::vector<vtkSmartPointer<vtkPlenoflameScene>> Scenes;
  std::vector<std::shared_ptr<const plenoflame::CompiledScene>> Compiled;
  std::unique_ptr<plenoflame::OperatorProblem> Problem;
  std::shared_ptr<const plenoflame::CsrMatrix<float>> Matrix;
  std::unique_ptr<plenoflame::LinearOperator> Operator;

  const plenoflame::Unknowns& unknowns() const { return *Problem->unknowns; }
  /// The operator refers to the matrix or the problem, and goes first.
  void forget() {
    Operator.reset();
    Matrix.reset();
    Problem.reset();
    Compiled.clear();
  }
};

namespace {

/// Hands over to who called.
template <class Array>
Array* released(vtkSmartPointer<Array> array) {
  array->Register(nullptr);
  return array.Get();
}

}  // namespace

vtkStandardNewMacro(vtkPlenoflameOperator);

vtkPlenoflameOperator::vtkPlenoflameOperator() : Internal(std::make_unique<Internals>()) {
  this->SetNumberOfInputPorts(0);
  this->SetNumberOfOutputPorts(0);
}

vtkPlenoflameOperator::~vtkPlenoflameOperator() = default;

void vtkPlenoflameOperator::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Cameras: " << this->Internal->Scenes.size() << "\n"
     << indent << "Rows: " << this->GetNumberOfRows() << "\n"
     << indent << "Columns: " << this->GetNumberOfColumns() << "\n"
     << indent << "Stored: " << this->Stored << "\n"
     << indent << "NumberOfThreads: " << this->NumberOfThreads << "\n";
}

bool vtkPlenoflameOperator::SetOption(const std::string& name, const std::string& value) {
  return pipeline::run_here(*this, [&] {
    plenoflame::OperatorRequest& request = this->Internal->Request;
    plenoflame::set_option(request, name, value);
    this->Internal->forget();
    this->Modified();
  });
}

void vtkPlenoflameOperator::AddCamera(vtkPlenoflameScene* scene) {
  this->Internal->Scenes.emplace_back(scene);
  this->Internal->forget();
  this->Modified();
}

int vtkPlenoflameOperator::RequestData(vtkInformation*, vtkInformationVector**,
                                       vtkInformationVector*) {
  using namespace plenoflame;
  Internals& in = *this->Internal;
  const bool ended = pipeline::run(*this, this->NumberOfThreads, [&](const Execution& execution) {
    if (in.Scenes.empty()) throw UsageError("an operator needs a camera");
    const Execution plain = execution.threads_only();
    if (!in.Problem) {
      check_operator(in.Request);
      in.forget();  // of a run that failed halfway
      std::vector<const CompiledScene*> scenes;
      for (const auto& scene : in.Scenes) {
        in.Compiled.push_back(scene->Compile(execution, {IssueCode::no_flame}));
        scenes.push_back(in.Compiled.back().get());
      }
      in.Problem = make_operator_problem(in.Request, scenes, "the scene", execution);
    }
    if (this->Stored && !in.Matrix) {
      in.Matrix = std::make_shared<const CsrMatrix<float>>(
          make_emission_matrix(in.Problem->problem, execution));
      in.Operator = make_csr_operator(*in.Matrix, plain);
    } else if (!in.Operator) {
      in.Operator = make_emission_operator(in.Problem->problem, plain);
    }
  });
  // Stopped before there was a result: there is none, and nothing went wrong.
  return ended || this->GetAbortExecute() ? 1 : 0;
}

vtkTypeInt64 vtkPlenoflameOperator::GetNumberOfRows() {
  const Internals& in = *this->Internal;
  return in.Problem ? static_cast<vtkTypeInt64>(in.Problem->rays.rows.size()) : 0;
}

vtkTypeInt64 vtkPlenoflameOperator::GetNumberOfColumns() {
  const Internals& in = *this->Internal;
  return in.Problem ? static_cast<vtkTypeInt64>(in.unknowns().size()) : 0;
}

vtkTypeInt64 vtkPlenoflameOperator::GetNumberOfRays() {
  const Internals& in = *this->Internal;
  return in.Problem ? static_cast<vtkTypeInt64>(in.Problem->rays.ray_count()) : 0;
}

double vtkPlenoflameOperator::GetMatrixBytes() {
  const Internals& in = *this->Internal;
  return in.Problem ? plenoflame::kBytesOfEntry *
                          static_cast<double>(estimated_entries(in.Problem->problem))
                    : 0;
}

bool vtkPlenoflameOperator::IsOfSource() {
  const Internals& in = *this->Internal;
  return in.Problem && in.Problem->problem.model == plenoflame::RowModel::source;
}

int vtkPlenoflameOperator::GetShape(int axis) {
  const Internals& in = *this->Internal;
  return in.Problem && axis >= 0 && axis < 3 ? in.unknowns().shape()[static_cast<std::size_t>(axis)]
                                             : 0;
}

vtkIntArray* vtkPlenoflameOperator::GetPixels() {
  vtkIntArray* const pixels = vtkIntArray::New();
  pixels->SetNumberOfComponents(3);
  if (this->Internal->Problem)
    for (const auto& row : this->Internal->Problem->rays.rows)
      for (const int value : {row.column, row.row, row.view}) pixels->InsertNextValue(value);
  return pixels;
}

vtkDoubleArray* vtkPlenoflameOperator::GetPlaces() {
  vtkDoubleArray* const places = vtkDoubleArray::New();
  places->SetNumberOfComponents(3);
  for (vtkTypeInt64 j = 0; j < this->GetNumberOfColumns(); ++j) {
    const auto p = this->Internal->unknowns().place(static_cast<std::size_t>(j));
    places->InsertNextTuple3(p.x, p.y, p.z);
  }
  return places;
}

vtkDoubleArray* vtkPlenoflameOperator::GetVolumes() {
  vtkDoubleArray* const volumes = vtkDoubleArray::New();
  for (vtkTypeInt64 j = 0; j < this->GetNumberOfColumns(); ++j)
    volumes->InsertNextValue(this->Internal->unknowns().volume(static_cast<std::size_t>(j)));
  return volumes;
}

vtkTypeInt64Array* vtkPlenoflameOperator::GetRowStarts() {
  static_assert(sizeof(std::int64_t) == sizeof(vtkTypeInt64));
  const auto& matrix = this->Internal->Matrix;
  if (!matrix) return nullptr;
  const auto starts = matrix->row_starts();
  return released(pipeline::SharedArray<vtkTypeInt64Array>::of(
      matrix, reinterpret_cast<const vtkTypeInt64*>(starts.data()), starts.size(), 1));
}

vtkIntArray* vtkPlenoflameOperator::GetColumnIndices() {
  const auto& matrix = this->Internal->Matrix;
  if (!matrix) return nullptr;
  const auto columns = matrix->column_indices();
  return released(
      pipeline::SharedArray<vtkIntArray>::of(matrix, columns.data(), columns.size(), 1));
}

vtkFloatArray* vtkPlenoflameOperator::GetValues() {
  const auto& matrix = this->Internal->Matrix;
  if (!matrix) return nullptr;
  const auto values = matrix->values();
  return released(
      pipeline::SharedArray<vtkFloatArray>::of(matrix, values.data(), values.size(), 1));
}

void vtkPlenoflameOperator::Apply(bool transpose, const double* in, double* out) {
  const plenoflame::LinearOperator* const a = this->Internal->Operator.get();
  if (!a) throw plenoflame::UsageError("the operator was not made: call Update()");
  if (transpose)
    a->apply_transpose(std::span<const double>(in, a->rows()),
                       std::span<double>(out, a->columns()));
  else
    a->apply(std::span<const double>(in, a->columns()), std::span<double>(out, a->rows()));
}
