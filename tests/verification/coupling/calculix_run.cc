#include "tests/verification/coupling/calculix_run.h"

#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace lipofill::verification {
namespace {

/// A folder that goes when the run is over.
class WorkFolder {
 public:
  WorkFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "lipofill-ccx-XXXXXX").string();
    if (mkdtemp(name.data()) != nullptr) path_ = name;
  }
  ~WorkFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

std::string read_end(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::stringstream all;
  all << stream.rdbuf();
  constexpr size_t kEnd = 1500;
  const std::string text = all.str();
  return text.substr(text.size() > kEnd ? text.size() - kEnd : 0);
}

/// The last table of displacements in a .dat file, which must be that of the whole load: lines
/// "node ux uy uz" [mm].
absl::StatusOr<Eigen::Matrix3Xd> read_displacements(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::vector<Eigen::Vector3d> rows;
  double time = 0.0;
  for (std::string line; std::getline(stream, line);) {
    if (absl::StrContains(line, "displacements")) {
      rows.clear();
      time = std::atof(line.substr(line.rfind("time") + 4).c_str());
      continue;
    }
    std::istringstream numbers(line);
    long node = 0;
    Eigen::Vector3d u;
    if (numbers >> node >> u[0] >> u[1] >> u[2]) rows.push_back(1e-3 * u);
  }
  if (rows.empty() || time < 1.0) return absl::InternalError(absl::StrCat("ccx got to ", time, " of the load"));
  Eigen::Matrix3Xd skin(3, rows.size());
  for (size_t k = 0; k < rows.size(); ++k) skin.col(static_cast<Eigen::Index>(k)) = rows[k];
  return skin;
}

}  // namespace

bool has_calculix() {
  return std::system("command -v ccx > /dev/null 2>&1") == 0;
}

absl::StatusOr<CalculixResult> solve_with_calculix(const std::string& deck) {
  const WorkFolder folder;
  std::ofstream file(folder.path() / "tissue.inp", std::ios::binary);
  file << deck;
  file.close();
  if (!file) return absl::InternalError(absl::StrCat("cannot write ", folder.path().string(), "/tissue.inp"));
  const auto begin = std::chrono::steady_clock::now();
  const int code = std::system(
      absl::StrCat("cd '", folder.path().string(), "' && OMP_NUM_THREADS=1 exec ccx tissue > ccx.log 2>&1").c_str());
  CalculixResult result;
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  auto skin = read_displacements(folder.path() / "tissue.dat");
  if (code != 0 || !skin.ok()) {
    return absl::InternalError(absl::StrCat("ccx ended with code ", code, ", ", skin.status().ToString(), ":\n",
                                            read_end(folder.path() / "ccx.log")));
  }
  result.skin = *std::move(skin);
  return result;
}

std::string with_neo_hookean_tissue(const std::string& deck) {
  const std::string card = "*ELASTIC\n";
  std::string result;
  size_t begin = 0;
  for (size_t at = deck.find(card); at != std::string::npos; at = deck.find(card, begin)) {
    const size_t values = at + card.size();
    const size_t end = deck.find('\n', values);
    const double youngs_modulus = std::stod(deck.substr(values, end - values));
    const double nu = std::stod(deck.substr(deck.find(',', values) + 1, end));
    const double shear = youngs_modulus / (2.0 * (1.0 + nu));
    const double bulk = youngs_modulus / (3.0 * (1.0 - 2.0 * nu));
    absl::StrAppend(&result, deck.substr(begin, at - begin), "*HYPERELASTIC, NEO HOOKE\n",
                    absl::StrFormat("%.12e, %.12e\n", 0.5 * shear, 2.0 / bulk));
    begin = end + 1;
  }
  return result + deck.substr(begin);
}

}  // namespace lipofill::verification
