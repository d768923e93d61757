#include "client/cpp/io/vtp_file.h"

#include <vtkNew.h>
#include <vtkXMLPolyDataReader.h>

#include "absl/strings/str_cat.h"
#include "client/cpp/io/vtk_messages.h"

namespace lipofill::client {

absl::StatusOr<vtkSmartPointer<vtkPolyData>> read_vtp(const std::filesystem::path& file) {
  const VtkMessages messages;
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  vtkSmartPointer<vtkPolyData> surface = reader->GetOutput();
  if (!messages.error().empty() || surface->GetNumberOfPoints() == 0) {
    return absl::InvalidArgumentError(absl::StrCat("cannot read the mesh ", file.string(), " ", messages.error()));
  }
  return surface;
}

}  // namespace lipofill::client
