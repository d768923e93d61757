#include "client/cpp/records/pacs.h"

#include <dcmtk/dcmdata/dctk.h>

#include <algorithm>
#include <map>
#include <memory>
#include <set>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cpp/dicom/dicom_library.h"
#include "client/cpp/dicom/frame_fields.h"
#include "client/cpp/records/pacs_scu.h"
#include "client/cpp/records/record.h"

namespace lipofill::client {
namespace {

constexpr size_t kTitleBytes = 16;
constexpr Uint32 kAssociationTimeoutS = 20;
constexpr Uint32 kAnswerTimeoutS = 120;
constexpr size_t kLineBytes = 64;

std::string words_of(const PacsAddress& pacs) {
  return absl::StrFormat("the PACS %s at %s:%d", pacs.title, pacs.host, pacs.port);
}

/// Deletes what an answer holds.
struct Answers {
  ~Answers() {
    for (QRResponse* each : list) delete each;
  }
  OFList<QRResponse*> list;
};

void ask_for(DcmDataset* keys, const DcmTagKey& tag, const std::string& value = "") {
  keys->putAndInsertString(tag, value.c_str());
}

/// A line for a terminal, out of what another program sent.
std::string line_of(DcmDataset* answer, const DcmTagKey& tag) {
  return plain_text(text_of(answer, tag), kLineBytes);
}

absl::StatusOr<std::vector<std::unique_ptr<DcmDataset>>> ask(const PacsAddress& pacs, DcmSCU* scu, DcmDataset* keys) {
  const T_ASC_PresentationContextID context =
      scu->findPresentationContextID(UID_FINDStudyRootQueryRetrieveInformationModel, "");
  if (context == 0)
    return absl::FailedPreconditionError(
        absl::StrCat(words_of(pacs), " does not offer to search (C-FIND, study root)"));
  Answers answers;
  const OFCondition sent = scu->sendFINDRequest(context, keys, &answers.list);
  if (sent.bad()) return absl::InternalError(absl::StrCat(words_of(pacs), " broke the search off: ", sent.text()));
  std::vector<std::unique_ptr<DcmDataset>> found;
  for (QRResponse* const answer : answers.list) {
    if (answer->m_dataset != nullptr) found.emplace_back(std::exchange(answer->m_dataset, nullptr));
    if (!DICOM_PENDING_STATUS(answer->m_status) && answer->m_status != STATUS_Success) {
      return absl::InternalError(
          absl::StrFormat("%s refused the search with status %04X", words_of(pacs), answer->m_status));
    }
  }
  return found;
}

DcmDataset study_keys(const PacsQuery& query) {
  DcmDataset keys;
  ask_for(&keys, DCM_QueryRetrieveLevel, "STUDY");
  ask_for(&keys, DCM_PatientID, query.patient_id);
  ask_for(&keys, DCM_AccessionNumber, query.accession_number);
  ask_for(&keys, DCM_StudyDate, query.study_date);
  ask_for(&keys, DCM_StudyInstanceUID, query.study_uid);
  return keys;
}

DcmDataset series_keys(const std::string& study_uid, const std::string& modality) {
  DcmDataset keys;
  ask_for(&keys, DCM_QueryRetrieveLevel, "SERIES");
  ask_for(&keys, DCM_StudyInstanceUID, study_uid);
  ask_for(&keys, DCM_Modality, modality);
  for (const DcmTagKey& tag :
       {DCM_SeriesInstanceUID, DCM_SeriesNumber, DCM_SeriesDescription, DCM_NumberOfSeriesRelatedInstances})
    ask_for(&keys, tag);
  return keys;
}

/// The contexts that the files need, each with the syntax that a file has.
absl::Status add_contexts(const std::vector<std::filesystem::path>& files, DcmSCU* scu) {
  std::map<std::string, std::set<std::string>> syntaxes;
  for (const std::filesystem::path& file : files) {
    DcmFileFormat format;
    if (format.loadFileUntilTag(file.c_str(), EXS_Unknown, EGL_noChange, DCM_MaxReadLength, ERM_fileOnly, DCM_StudyDate)
            .bad()) {
      return absl::InvalidArgumentError(absl::StrCat(file.string(), " is not a file of DICOM"));
    }
    const DcmXfer syntax(format.getDataset()->getOriginalXfer());
    syntaxes[text_of(format.getDataset(), DCM_SOPClassUID)].insert(syntax.getXferID());
  }
  for (const auto& [class_uid, ids] : syntaxes) {
    for (const std::string& id : ids) {
      OFList<OFString> one;
      one.push_back(id.c_str());
      scu->addPresentationContext(class_uid.c_str(), one);
    }
  }
  return absl::OkStatus();
}

}  // namespace

void address_scu(const PacsAddress& pacs, DcmSCU* scu) {
  prepare_dicom_library();
  scu->setAETitle(pacs.own_title.c_str());
  scu->setPeerAETitle(pacs.title.c_str());
  scu->setPeerHostName(pacs.host.c_str());
  scu->setPeerPort(pacs.port);
  scu->setACSETimeout(kAssociationTimeoutS);
  scu->setConnectionTimeout(static_cast<Sint32>(kAssociationTimeoutS));
  scu->setDIMSETimeout(kAnswerTimeoutS);
  scu->setDIMSEBlockingMode(DIMSE_NONBLOCKING);
}

absl::Status open_association(const PacsAddress& pacs, DcmSCU* scu) {
  OFCondition opened = scu->initNetwork();
  if (opened.good()) opened = scu->negotiateAssociation();
  if (opened.good()) return absl::OkStatus();
  const std::string who = words_of(pacs);
  if (opened == DUL_ASSOCIATIONREJECTED) {
    return absl::PermissionDeniedError(absl::StrCat(who, " does not let ", pacs.own_title,
                                                    " in: it has to know that title, and to be called ", pacs.title));
  }
  if (opened == NET_EC_NoAcceptablePresentationContexts || opened == NET_EC_NoPresentationContextsDefined)
    return absl::FailedPreconditionError(absl::StrCat(who, " takes none of these kinds of objects"));
  return absl::UnavailableError(absl::StrCat("cannot reach ", who, ": ", plain_text(opened.text(), 200)));
}

OFList<OFString> plain_syntaxes() {
  OFList<OFString> syntaxes;
  syntaxes.push_back(UID_LittleEndianExplicitTransferSyntax);
  syntaxes.push_back(UID_LittleEndianImplicitTransferSyntax);
  return syntaxes;
}

absl::StatusOr<PacsAddress> parse_pacs_address(const std::string& text, const std::string& own_title) {
  PacsAddress pacs;
  const size_t at = text.find('@');
  const size_t colon = text.rfind(':');
  int port = 0;
  if (at == std::string::npos || colon == std::string::npos || colon < at || at == 0 || colon == at + 1 ||
      !absl::SimpleAtoi(text.substr(colon + 1), &port) || port < 1 || port > 65535) {
    return absl::InvalidArgumentError(absl::StrCat(
        "'", text, "' is no address of a PACS; it is written TITLE@HOST:PORT, as in ORTHANC@localhost:4242"));
  }
  pacs.title = text.substr(0, at);
  pacs.host = text.substr(at + 1, colon - at - 1);
  pacs.port = static_cast<uint16_t>(port);
  pacs.own_title = own_title;
  for (const std::string& title : {pacs.title, pacs.own_title}) {
    if (title.empty() || title.size() > kTitleBytes || plain_text(title, kTitleBytes) != title)
      return absl::InvalidArgumentError(absl::StrCat("the title '", title, "' must be 1 to 16 plain characters"));
  }
  return pacs;
}

absl::StatusOr<std::vector<PacsSeries>> find_in_pacs(const PacsAddress& pacs, const PacsQuery& query) {
  DcmSCU scu;
  address_scu(pacs, &scu);
  scu.addPresentationContext(UID_FINDStudyRootQueryRetrieveInformationModel, plain_syntaxes());
  if (auto status = open_association(pacs, &scu); !status.ok()) return status;
  DcmDataset keys = study_keys(query);
  const auto studies = ask(pacs, &scu, &keys);
  if (!studies.ok()) return studies.status();
  if (studies->size() > kMostStudies) {
    return absl::OutOfRangeError(absl::StrCat(studies->size(), " studies are found, more than the ", kMostStudies,
                                              " that are looked into; narrow the search"));
  }
  std::vector<PacsSeries> found;
  for (const auto& study : *studies) {
    DcmDataset of_study = series_keys(text_of(study.get(), DCM_StudyInstanceUID), query.modality);
    const auto all = ask(pacs, &scu, &of_study);
    if (!all.ok()) return all.status();
    for (const auto& series : *all) {
      found.push_back({line_of(study.get(), DCM_StudyInstanceUID), line_of(study.get(), DCM_StudyDate),
                       line_of(series.get(), DCM_SeriesInstanceUID), line_of(series.get(), DCM_SeriesNumber),
                       line_of(series.get(), DCM_Modality), line_of(series.get(), DCM_SeriesDescription),
                       line_of(series.get(), DCM_NumberOfSeriesRelatedInstances)});
    }
  }
  scu.releaseAssociation();
  std::sort(found.begin(), found.end(), [](const PacsSeries& a, const PacsSeries& b) {
    return std::tie(a.study_date, a.study_uid, a.series_uid) < std::tie(b.study_date, b.study_uid, b.series_uid);
  });
  return found;
}

absl::Status send_to_pacs(const PacsAddress& pacs, const std::vector<std::filesystem::path>& files) {
  DcmSCU scu;
  address_scu(pacs, &scu);
  if (auto status = add_contexts(files, &scu); !status.ok()) return status;
  if (auto status = open_association(pacs, &scu); !status.ok()) return status;
  for (const std::filesystem::path& file : files) {
    Uint16 answer = 0;
    const OFCondition sent = scu.sendSTORERequest(0, file.c_str(), nullptr, answer);
    if (sent.bad()) {
      return absl::FailedPreconditionError(
          absl::StrCat(words_of(pacs), " did not take ", file.string(), ": ", plain_text(sent.text(), 200)));
    }
    if (answer != STATUS_Success && !DICOM_WARNING_STATUS(answer)) {
      return absl::FailedPreconditionError(
          absl::StrFormat("%s refused %s with status %04X", words_of(pacs), file.string(), answer));
    }
  }
  scu.releaseAssociation();
  return absl::OkStatus();
}

}  // namespace lipofill::client
