#pragma once

#include "lipofill/v1/patient_service.grpc.pb.h"
#include "server/backend/backend.h"
#include "server/patients/scan_upload.h"

namespace lipofill::server {

/// Patients, scans and models. See proto/lipofill/v1/patient_service.proto for what each call does.
class PatientService : public v1::PatientService::CallbackService {
 public:
  explicit PatientService(Backend& backend) : backend_(backend), uploads_(backend) {}

  using Context = grpc::CallbackServerContext;
  using Reactor = grpc::ServerUnaryReactor;

  Reactor* CreatePatient(Context* context, const v1::CreatePatientRequest* request, v1::Patient* response) override;
  Reactor* GetPatient(Context* context, const v1::GetPatientRequest* request, v1::Patient* response) override;
  Reactor* ListPatients(Context* context, const v1::ListPatientsRequest* request,
                        v1::ListPatientsResponse* response) override;
  Reactor* UpdatePatient(Context* context, const v1::UpdatePatientRequest* request, v1::Patient* response) override;
  Reactor* DeletePatient(Context* context, const v1::DeletePatientRequest* request,
                         google::protobuf::Empty* response) override;

  Reactor* CreateScan(Context* context, const v1::CreateScanRequest* request, v1::Scan* response) override;
  grpc::ServerReadReactor<v1::UploadScanRequest>* UploadScan(Context* context, v1::Scan* response) override;
  Reactor* GetScan(Context* context, const v1::GetScanRequest* request, v1::Scan* response) override;
  Reactor* ListScans(Context* context, const v1::ListScansRequest* request, v1::ListScansResponse* response) override;
  Reactor* DeleteScan(Context* context, const v1::DeleteScanRequest* request,
                      google::protobuf::Empty* response) override;

  Reactor* BuildModel(Context* context, const v1::BuildModelRequest* request, v1::Operation* response) override;
  Reactor* GetModel(Context* context, const v1::GetModelRequest* request, v1::Model* response) override;
  Reactor* ListModels(Context* context, const v1::ListModelsRequest* request,
                      v1::ListModelsResponse* response) override;
  Reactor* DeleteModel(Context* context, const v1::DeleteModelRequest* request,
                       google::protobuf::Empty* response) override;
  grpc::ServerWriteReactor<v1::MeshSlice>* DownloadScanMesh(Context* context,
                                                            const v1::DownloadScanMeshRequest* request) override;
  grpc::ServerWriteReactor<v1::MeshSlice>* DownloadModelMesh(Context* context,
                                                             const v1::DownloadModelMeshRequest* request) override;

 private:
  Backend& backend_;
  ScanUploads uploads_;
};

}  // namespace lipofill::server
