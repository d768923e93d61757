#include "server/wire/resource_names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lipofill/v1/patient_service.pb.h"
#include "lipofill/v1/simulation_service.pb.h"

namespace lipofill::server {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(ResourceNames, AreFoundInFieldsOfAnyDepth) {
  v1::BuildModelRequest request;
  request.set_parent("patients/a");
  request.mutable_spec()->mutable_scan_region()->set_scan("patients/b/scans/s");
  const ResourceNames names = resource_names_in(request);
  EXPECT_THAT(names.patients, ElementsAre("a", "b"));
  EXPECT_THAT(names.whole, ElementsAre("patients/a", "patients/b/scans/s"));
  EXPECT_EQ(names.size(), 2u);

  v1::EvaluateSimulationRequest evaluate;
  evaluate.set_name("simulations/x/checkpoints/c");
  evaluate.set_target_scan("patients/p/scans/s");
  EXPECT_THAT(resource_names_in(evaluate).simulations, ElementsAre("x"));
  EXPECT_THAT(resource_names_in(evaluate).patients, ElementsAre("p"));
  evaluate.set_name("operations/o1");
  EXPECT_THAT(resource_names_in(evaluate).operations, ElementsAre("o1"));

  v1::CreatePatientRequest create;
  (*create.mutable_labels())["k"] = "patients/c";
  EXPECT_THAT(resource_names_in(create).patients, ElementsAre("c")) << "whatever the field";
}

TEST(ResourceNames, WhatIsNoneIsLeftToTheMethod) {
  v1::GetPatientRequest request;
  for (const std::string& text :
       {std::string(), std::string("patients/"), std::string("patients"), std::string("patients/Erika Mustermann"),
        std::string("film/deep.pressure"), std::string("patients/../x"), "patients/" + std::string(300, 'a')}) {
    request.set_name(text);
    EXPECT_EQ(resource_names_in(request).size(), 0u) << text;
    EXPECT_THAT(resource_names_in(request).whole, IsEmpty()) << text;
  }
  request.set_name("patients/a/scans/Erika Mustermann");
  EXPECT_THAT(resource_names_in(request).patients, ElementsAre("a"));
  EXPECT_THAT(resource_names_in(request).whole, IsEmpty()) << "nothing but pseudonyms gets into the audit log";
}

}  // namespace
}  // namespace lipofill::server
