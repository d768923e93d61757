// The daemon's services, by gRPC-Web through whoever served this page.
import { createClient, type Interceptor } from "@connectrpc/connect";
import { createGrpcWebTransport } from "@connectrpc/connect-web";
import { signal } from "@preact/signals";
import { ForecastService } from "@wire/forecast_service_pb";
import { FrameService } from "@wire/frame_service_pb";
import { OperationService } from "@wire/operation_service_pb";
import { PatientService } from "@wire/patient_service_pb";
import { PlanService } from "@wire/plan_service_pb";
import { PlanningService } from "@wire/planning_service_pb";
import { SimulationService } from "@wire/simulation_service_pb";

const tokenKey = "lipofill.token";

/** The bearer token calls carry; empty: none. It lives as long as the tab. */
export const token = signal(sessionStorage.getItem(tokenKey) ?? "");

export function setToken(value: string): void {
  token.value = value.trim();
  sessionStorage.setItem(tokenKey, token.value);
}

const withCredentials: Interceptor = (next) => (request) => {
  if (token.value) request.header.set("authorization", `Bearer ${token.value}`);
  request.header.set("x-request-id", newId());
  return next(request);
};

/** A name that is hard to guess, of the form the daemon takes for ids: a letter first. */
export function newId(): string {
  return `w${crypto.getRandomValues(new Uint32Array(4)).reduce((text, n) => text + n.toString(16).padStart(8, "0"), "")}`;
}

export const transport = createGrpcWebTransport({ baseUrl: location.origin, interceptors: [withCredentials] });
export const patients = createClient(PatientService, transport);
export const simulations = createClient(SimulationService, transport);
export const frames = createClient(FrameService, transport);
export const plans = createClient(PlanService, transport);
export const planning = createClient(PlanningService, transport);
export const forecasts = createClient(ForecastService, transport);
export const operations = createClient(OperationService, transport);
