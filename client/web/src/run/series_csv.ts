// The time series as the table that `lipofill run` writes: all figures of a row, under their names
// in the schema.
import { create, type DescField, type DescMessage, type Message } from "@bufbuild/protobuf";
import { reflect } from "@bufbuild/protobuf/reflect";
import { SeriesRowSchema, type Probe, type SeriesRow } from "@wire/simulation_pb";

interface Column {
  name: string;
  /** from the row to the figure */
  path: DescField[];
  /** which one of a figure that every probe has */
  probe?: number;
}

const ofProbes = "probe_";

/** All figures of one probe side by side, as "probe_NAME_thickness_mm". */
function columnsOfProbes(of: DescMessage, above: DescField[], probes: string[]): Column[] {
  const repeated = of.fields.filter(({ fieldKind }) => fieldKind === "list");
  return probes.flatMap((name, probe) =>
    repeated.map((field) => ({
      name: `${ofProbes}${name}_${field.name.slice(ofProbes.length)}`,
      path: [...above, field],
      probe,
    })),
  );
}

function columnsOf(of: DescMessage, above: DescField[], probes: string[]): Column[] {
  const first = of.fields.find(({ fieldKind }) => fieldKind === "list");
  return of.fields.flatMap((field) => {
    const path = [...above, field];
    if (field.fieldKind === "list") return field === first ? columnsOfProbes(of, above, probes) : [];
    if (field.fieldKind === "message") return columnsOf(field.message, path, probes);
    return [{ name: field.name, path }];
  });
}

type Figure = number | bigint | undefined;

function valueOf(row: SeriesRow, { path, probe }: Column): string {
  const holder = path.slice(0, -1).reduce<Message | undefined>((of, { localName }) => {
    return (of as unknown as Record<string, Message | undefined> | undefined)?.[localName];
  }, row);
  const value = (holder as unknown as Record<string, Figure | Figure[]> | undefined)?.[path.at(-1)!.localName];
  const figure = Array.isArray(value) ? value[probe ?? 0] : value;
  return figure === undefined ? "" : String(figure);
}

export function writeSeries(rows: SeriesRow[], probes: Probe[]): string {
  const columns = columnsOf(
    SeriesRowSchema,
    [],
    probes.map(({ name }) => name),
  );
  const lines = rows.map((row) => columns.map((column) => valueOf(row, column)).join(","));
  return `${[columns.map(({ name }) => name).join(","), ...lines].join("\n")}\n`;
}

/** Figures of the rows themselves; those of probes and of computing are for other programs. */
export function parseSeries(text: string): SeriesRow[] {
  const [head, ...lines] = text.trim().split(/\r?\n/);
  const names = head.split(",");
  const known = SeriesRowSchema.fields.filter(
    ({ fieldKind, name }) => fieldKind === "scalar" && names.includes(name),
  ) as (DescField & { fieldKind: "scalar" })[];
  return lines.map((line) => {
    const cells = line.split(",");
    const row = reflect(SeriesRowSchema, create(SeriesRowSchema));
    for (const field of known) {
      const value = Number(cells[names.indexOf(field.name)] ?? 0);
      row.set(field, typeof row.get(field) === "bigint" ? BigInt(Math.round(value)) : value);
    }
    return row.message as SeriesRow;
  });
}
