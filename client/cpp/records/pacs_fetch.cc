#include <dcmtk/dcmdata/dctk.h>

#include <memory>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cpp/records/pacs.h"
#include "client/cpp/records/pacs_scu.h"

namespace lipofill::client {
namespace {

/// These classes are fetched: those of volumes, and those of records.
const char* const kFetched[] = {
    UID_CTImageStorage,         UID_EnhancedCTImageStorage,         UID_MRImageStorage,
    UID_EnhancedMRImageStorage, UID_XRay3DAngiographicImageStorage, UID_XRay3DCraniofacialImageStorage,
    UID_SegmentationStorage,    UID_ComprehensiveSRStorage,         UID_EncapsulatedPDFStorage,
    UID_EncapsulatedSTLStorage};

/// Takes the objects that a PACS sends back, under numbers.
class Fetcher : public DcmSCU {
 public:
  size_t count() const { return count_; }

 protected:
  OFString createStorageFilename(DcmDataset* /*dataset*/) override {
    const std::string name = absl::StrFormat("%06d.dcm", ++count_);
    return OFString((std::filesystem::path(getStorageDir().c_str()) / name).c_str());
  }

 private:
  size_t count_ = 0;
};

/// Deletes what an answer holds.
struct Answers {
  ~Answers() {
    for (RetrieveResponse* each : list) delete each;
  }
  OFList<RetrieveResponse*> list;
};

absl::Status make_empty_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    return absl::InvalidArgumentError(absl::StrCat("cannot make the folder ", folder.string(), ": ", error.message()));
  if (!std::filesystem::is_empty(folder, error) || error) {
    return absl::InvalidArgumentError(
        absl::StrCat("the folder ", folder.string(), " is not empty: what is fetched would mix with what is there"));
  }
  std::filesystem::permissions(folder, std::filesystem::perms::owner_all, error);
  return absl::OkStatus();
}

absl::Status check_end(const PacsAddress& pacs, const OFList<RetrieveResponse*>& answers) {
  if (answers.empty()) return absl::InternalError(absl::StrCat(pacs.title, " ended the retrieval without an answer"));
  const RetrieveResponse& last = *answers.back();
  if (last.m_status == STATUS_Success) return absl::OkStatus();
  if (last.m_numberOfCompletedSubops == 0) {
    return absl::NotFoundError(
        absl::StrFormat("%s ended the retrieval with status %04X before any object came: it may not have that study or "
                        "series; lipofill records find lists what it has",
                        pacs.title, last.m_status));
  }
  return absl::InternalError(absl::StrFormat("%s ended the retrieval with status %04X; %d objects did not come",
                                             pacs.title, last.m_status, last.m_numberOfFailedSubops));
}

}  // namespace

absl::StatusOr<size_t> fetch_from_pacs(const PacsAddress& pacs, const std::string& study_uid,
                                       const std::string& series_uid, const std::filesystem::path& folder) {
  if (auto status = make_empty_folder(folder); !status.ok()) return status;
  Fetcher scu;
  address_scu(pacs, &scu);
  scu.setStorageDir(folder.c_str());
  scu.setStorageMode(DCMSCU_STORAGE_DISK);
  scu.addPresentationContext(UID_GETStudyRootQueryRetrieveInformationModel, plain_syntaxes());
  for (const char* const class_uid : kFetched) scu.addPresentationContext(class_uid, plain_syntaxes(), ASC_SC_ROLE_SCP);
  if (auto status = open_association(pacs, &scu); !status.ok()) return status;
  const T_ASC_PresentationContextID context =
      scu.findPresentationContextID(UID_GETStudyRootQueryRetrieveInformationModel, "");
  if (context == 0)
    return absl::FailedPreconditionError(absl::StrCat(pacs.title, " does not offer to be fetched from (C-GET)"));
  DcmDataset keys;
  keys.putAndInsertString(DCM_QueryRetrieveLevel, series_uid.empty() ? "STUDY" : "SERIES");
  keys.putAndInsertString(DCM_StudyInstanceUID, study_uid.c_str());
  if (!series_uid.empty()) keys.putAndInsertString(DCM_SeriesInstanceUID, series_uid.c_str());
  Answers answers;
  const OFCondition fetched = scu.sendCGETRequest(context, &keys, &answers.list);
  if (fetched.bad()) return absl::InternalError(absl::StrCat(pacs.title, " broke the retrieval off: ", fetched.text()));
  if (auto status = check_end(pacs, answers.list); !status.ok()) return status;
  scu.releaseAssociation();
  if (scu.count() == 0) {
    return absl::NotFoundError(
        absl::StrCat(pacs.title,
                     " has no object of that study or series that could be fetched; lipofill records find "
                     "lists what it has"));
  }
  return scu.count();
}

}  // namespace lipofill::client
