// The patient of this page, under a pseudonym that says nothing of a person.
import { newId, patients } from "../api/client";
import { patient, patientName } from "./state";

/** "case-2026-11-30-k7q2x": the day, and letters that are nobody's. */
export function pseudonym(now = new Date()): string {
  const letters = "abcdefghjkmnpqrstuvwxyz23456789";
  const made = Array.from(crypto.getRandomValues(new Uint8Array(5)), (n) => letters[n % letters.length]).join("");
  return `case-${now.toISOString().slice(0, 10)}-${made}`;
}

export async function createPatient(displayName = pseudonym()): Promise<{ name: string; displayName: string }> {
  return patients.createPatient({ requestId: newId(), displayName });
}

/** The patient of this page; made up when there is none yet. */
export async function ensurePatient(): Promise<string> {
  if (patient.value === "") {
    const { name, displayName } = await createPatient();
    [patient.value, patientName.value] = [name, displayName];
  }
  return patient.value;
}
