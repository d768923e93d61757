// Asks for shapes while a volume is dragged, and once more when it is let go.
import { Code, ConnectError } from "@connectrpc/connect";
import { toProblem } from "../api/errors";
import { findShape, type Shape, type ShapeRequest } from "../api/find_shape";
import { Latest } from "../api/latest";
import { fieldWords, plainWords } from "../plan/field_words";
import { plan } from "../plan/state";
import { clear, isFinal, refuse, shapeOf, show, type ShapeOf } from "./state";

interface Question {
  face: string;
  request: ShapeRequest;
  final: boolean;
}

/** In plain words; the daemon names the field of the plan that has to be stepped. */
export function wordsOf(error: unknown): string {
  const { message, violations } = toProblem(error);
  const details = violations
    .map(({ field, description }) => `${fieldWords(field, plan.value)} ${plainWords(description, plan.value)}`)
    .join("; ");
  const said = details === "" ? message : details;
  if (ConnectError.from(error).code !== Code.FailedPrecondition) return said;
  return `This plan has to be run to see its shape: ${said}. The slider changes the plan all the same.`;
}

let dragging = false;
/** The plan has to be stepped: there is nothing to ask before the next drag. */
let outOfScope = false;

const latest = new Latest<Question, Shape>(({ face, request }, left) => findShape(face, request, left), {
  answered: (shape, { final }) => show(shape, final),
  failed(error) {
    outOfScope = ConnectError.from(error).code === Code.FailedPrecondition;
    refuse(wordsOf(error));
  },
});

/** Forgets the shape, and the question that may be on its way. */
export function forgetShape(): void {
  latest.forget();
  [dragging, outOfScope] = [false, false];
  clear();
}

/** Whether a drag begins; whose shape is shown is then `of`. */
export function beginDrag(of: ShapeOf): boolean {
  if (dragging && shapeOf.value === of) return false;
  if (shapeOf.value !== of) forgetShape();
  [dragging, outOfScope] = [true, false];
  shapeOf.value = of;
  return true;
}

export function findWhileDragged(face: string, request: ShapeRequest): void {
  isFinal.value = false;
  if (!outOfScope) latest.want({ face, request, final: false });
}

/** Found from rest: equal volumes give equal figures, however they were dragged. */
export function findFinal(face: string, request: ShapeRequest): void {
  dragging = false;
  if (!outOfScope) latest.want({ face, request: { ...request, fromRest: true }, final: true });
}
