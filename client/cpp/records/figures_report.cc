#include "client/cpp/records/figures_report.h"

#include <dcmtk/dcmsr/codes/dcm.h>
#include <dcmtk/dcmsr/dsrdoc.h>

#include <array>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "client/cpp/records/record.h"
#include "client/cpp/records/record_uid.h"
#include "client/cpp/result_text.h"

namespace lipofill::client {
namespace {

constexpr size_t kTextBytes = 1024;
constexpr char kScheme[] = "99LIPOFILL";

/// A figure of a JSON object, and what it is called in a report.
struct Figure {
  const char* key;
  DSRBasicCodedEntry concept_name;
  const char* unit;
};

const DSRBasicCodedEntry kVolume("118565006", "SCT", "Volume");

const std::array<Figure, 7> kPlanFigures = {{
    {"injected_ml", {"INJECTED", kScheme, "Injected volume of fat"}, "mL"},
    {"skin_volume_change_ml", {"SKINVOLUME", kScheme, "Volume that the skin gained"}, "mL"},
    {"skin_max_displacement_mm", {"LIFT", kScheme, "Largest displacement of the skin"}, "mm"},
    {"max_thickness_mm", {"THICKNESS", kScheme, "Largest thickness of the fat"}, "mm"},
    {"max_pressure_pa", {"MAXPRESSURE", kScheme, "Largest pressure of the fat"}, "Pa"},
    {"mean_pressure_pa", {"MEANPRESSURE", kScheme, "Mean pressure of the fat"}, "Pa"},
    {"undelivered_ml", {"UNDELIVERED", kScheme, "Volume that was not there to be taken out"}, "mL"},
}};
const std::array<Figure, 3> kZoneFigures = {{
    {"volume_ml", kVolume, "mL"},
    {"mean_pressure_pa", {"MEANPRESSURE", kScheme, "Mean pressure of the fat"}, "Pa"},
    {"max_thickness_mm", {"THICKNESS", kScheme, "Largest thickness of the fat"}, "mm"},
}};
const std::array<Figure, 4> kTargetFigures = {{
    {"mean_mm", {"TARGETMEAN", kScheme, "Mean distance of the planned skin to its target"}, "mm"},
    {"median_mm", {"TARGETMEDIAN", kScheme, "Median distance of the planned skin to its target"}, "mm"},
    {"p95_mm", {"TARGETP95", kScheme, "Distance to the target that 95 of 100 places are below"}, "mm"},
    {"max_mm", {"TARGETMAX", kScheme, "Largest distance of the planned skin to its target"}, "mm"},
}};

/// Builds the tree of a report from its root on.
class ReportTree {
 public:
  explicit ReportTree(DSRDocumentTree* tree) : tree_(*tree) {}

  void begin() {
    add(DSRTypes::RT_isRoot, DSRTypes::VT_Container, CODE_DCM_ImagingMeasurementReport, DSRTypes::AM_afterCurrent);
    add(DSRTypes::RT_hasConceptMod, DSRTypes::VT_Code, CODE_DCM_LanguageOfContentItemAndDescendants,
        DSRTypes::AM_belowCurrent);
    tree_.getCurrentContentItem().setCodeValue(DSRBasicCodedEntry("en", "RFC5646", "English"));
    add(DSRTypes::RT_hasObsContext, DSRTypes::VT_Code, CODE_DCM_ObserverType);
    tree_.getCurrentContentItem().setCodeValue(CODE_DCM_Device);
    add(DSRTypes::RT_hasObsContext, DSRTypes::VT_UIDRef, CODE_DCM_DeviceObserverUID);
    tree_.getCurrentContentItem().setStringValue(uid_of("device", "Lipofill").c_str());
    text(DSRTypes::RT_hasObsContext, CODE_DCM_DeviceObserverName, "Lipofill");
    text(DSRTypes::RT_contains, CODE_DCM_Comment, kNotAMedicalDevice);
  }

  void text(DSRTypes::E_RelationshipType relationship, const DSRCodedEntryValue& name, const std::string& value) {
    add(relationship, DSRTypes::VT_Text, name);
    tree_.getCurrentContentItem().setStringValue(plain_text(value, kTextBytes).c_str());
  }

  void begin_measurements() {
    add(DSRTypes::RT_contains, DSRTypes::VT_Container, CODE_DCM_ImagingMeasurements);
    first_ = true;
  }

  /// A group for the figures that an object has; those that are absent or null are left out.
  template <size_t n>
  void group(const std::string& name, const nlohmann::json& object, const std::array<Figure, n>& figures) {
    add(DSRTypes::RT_contains, DSRTypes::VT_Container, CODE_DCM_MeasurementGroup, place());
    add(DSRTypes::RT_hasObsContext, DSRTypes::VT_Text, CODE_DCM_TrackingIdentifier, DSRTypes::AM_belowCurrent);
    tree_.getCurrentContentItem().setStringValue(plain_text(name, kTextBytes).c_str());
    add(DSRTypes::RT_hasObsContext, DSRTypes::VT_UIDRef, CODE_DCM_TrackingUniqueIdentifier);
    tree_.getCurrentContentItem().setStringValue(uid_of("tracking", absl::StrCat(name, object.dump())).c_str());
    for (const Figure& figure : figures) {
      const auto found = object.find(figure.key);
      if (found == object.end() || !found->is_number() || !std::isfinite(found->template get<double>())) continue;
      add(DSRTypes::RT_contains, DSRTypes::VT_Num, figure.concept_name);
      tree_.getCurrentContentItem().setNumericValue(DSRNumericMeasurementValue(
          decimal_string(found->template get<double>()).c_str(), DSRBasicCodedEntry(figure.unit, "UCUM", figure.unit)));
    }
    tree_.goUp();
  }

  void end_measurements() { tree_.goUp(); }

  /// Tells whether every item found its place.
  bool is_whole() const { return whole_; }

 private:
  DSRTypes::E_AddMode place() {
    const bool first = std::exchange(first_, false);
    return first ? DSRTypes::AM_belowCurrent : DSRTypes::AM_afterCurrent;
  }

  void add(DSRTypes::E_RelationshipType relationship, DSRTypes::E_ValueType type, const DSRCodedEntryValue& name,
           DSRTypes::E_AddMode mode = DSRTypes::AM_afterCurrent) {
    whole_ = tree_.addContentItem(relationship, type, mode) != 0 && whole_;
    whole_ = tree_.getCurrentContentItem().setConceptName(name).good() && whole_;
  }

  DSRDocumentTree& tree_;
  bool first_ = false;
  bool whole_ = true;
};

void fill(const FinishedPlan& plan, ReportTree* tree) {
  tree->begin();
  for (const nlohmann::json& remark : plan.summary.value("remarks", nlohmann::json::array())) {
    if (remark.is_string()) tree->text(DSRTypes::RT_contains, CODE_DCM_Comment, remark.get<std::string>());
  }
  tree->begin_measurements();
  tree->group(absl::StrCat("plan ", plan.name), plan.summary, kPlanFigures);
  for (const nlohmann::json& zone : plan.summary.value("zones", nlohmann::json::array())) {
    if (zone.is_object()) tree->group(absl::StrCat("zone ", zone.value("name", "")), zone, kZoneFigures);
  }
  if (plan.evaluation.is_object() && plan.evaluation.contains("simulated_to_target"))
    tree->group("target", plan.evaluation["simulated_to_target"], kTargetFigures);
  tree->end_measurements();
}

}  // namespace

absl::StatusOr<std::unique_ptr<DcmDataset>> make_figures_record(const RecordStudy& study, const FinishedPlan& plan) {
  if (!plan.summary.contains("injected_ml")) return absl::InvalidArgumentError("summary.json has no injected_ml");
  DSRDocument document;
  document.createNewDocument(DSRTypes::DT_ComprehensiveSR);
  document.createNewSeriesInStudy(study.study_uid.c_str());
  ReportTree tree(&document.getTree());
  fill(plan, &tree);
  document.completeDocument("Computed; nobody has verified it.");
  auto record = std::make_unique<DcmDataset>();
  const OFCondition written = document.write(*record);
  if (written.bad() || !tree.is_whole())
    return absl::InternalError(absl::StrCat("cannot write the structured report: ", written.text()));
  finish_record(study, kFiguresRecord, plan.finished, record.get());
  return record;
}

}  // namespace lipofill::client
