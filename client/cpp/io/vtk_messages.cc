#include "client/cpp/io/vtk_messages.h"

#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>

#include <algorithm>

namespace lipofill::client {

class VtkMessages::Window : public vtkOutputWindow {
 public:
  static Window* New();
  vtkTypeMacro(Window, vtkOutputWindow)

      void DisplayErrorText(const char* text) override {
    if (!error.empty()) return;
    error = text;
    // Takes the last part, which is for people, from "ERROR: In file.cxx, line 12\nvtkReader
    // (0x...): what went wrong".
    const size_t what = error.find("): ");
    if (what != std::string::npos) error.erase(0, what + 3);
    while (!error.empty() && error.back() == '\n') error.pop_back();
    std::replace(error.begin(), error.end(), '\n', ' ');
  }
  void DisplayText(const char* text) override { static_cast<void>(text); }
  void DisplayWarningText(const char* text) override { static_cast<void>(text); }
  void DisplayGenericWarningText(const char* text) override { static_cast<void>(text); }
  void DisplayDebugText(const char* text) override { static_cast<void>(text); }

  std::string error;
};

vtkStandardNewMacro(VtkMessages::Window)

    VtkMessages::VtkMessages()
    : window_(vtkSmartPointer<Window>::New()), previous_(vtkOutputWindow::GetInstance()) {
  vtkOutputWindow::SetInstance(window_);
}

VtkMessages::~VtkMessages() {
  vtkOutputWindow::SetInstance(previous_);
}

const std::string& VtkMessages::error() const {
  return window_->error;
}

}  // namespace lipofill::client
