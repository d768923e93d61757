// Units of a scan's file, as people choose them.
import { ScanUnit } from "@wire/plan_pb";

export const units = [
  { value: ScanUnit.MILLIMETRE, label: "Millimetres" },
  { value: ScanUnit.CENTIMETRE, label: "Centimetres" },
  { value: ScanUnit.METRE, label: "Metres" },
];
