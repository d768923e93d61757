#pragma once

#include <string>

#include <vtkSmartPointer.h>

class vtkOutputWindow;

namespace lipofill::client {

/// Collects what VTK would print, from here to the end of the scope: its readers and writers tell
/// of errors in no other way.
class VtkMessages {
 public:
  VtkMessages();
  ~VtkMessages();
  VtkMessages(const VtkMessages&) = delete;
  VtkMessages& operator=(const VtkMessages&) = delete;

  /// The first error, on one line; empty when there was none.
  const std::string& error() const;

 private:
  class Window;
  vtkSmartPointer<Window> window_;
  vtkSmartPointer<vtkOutputWindow> previous_;
};

}  // namespace lipofill::client
