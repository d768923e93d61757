// A small line plot over simulated time.
interface Line {
  name: string;
  colour: string;
  values: number[];
}

interface Props {
  title: string;
  unit: string;
  times: number[];
  lines: Line[];
  /** shown as a vertical line */
  now?: number;
  onPick?: (timeS: number) => void;
}

const [width, height, left, bottom, top] = [260, 92, 34, 15, 6];

/** At most so many points are drawn. */
const mostPoints = 400;

function ticks(high: number): number[] {
  const raw = high / 2;
  const power = 10 ** Math.floor(Math.log10(raw));
  const size = [1, 2, 5, 10].map((k) => k * power).find((candidate) => candidate >= raw * 0.7) ?? raw;
  return Array.from({ length: Math.floor(high / size) + 1 }, (_, k) => k * size);
}

export function Plot({ title, unit, times, lines, now, onPick }: Props) {
  const end = Math.max(times.at(-1) ?? 0, 1e-3);
  const largest = lines.reduce((high, { values }) => values.reduce((h, v) => Math.max(h, v), high), 0);
  const high = largest > 0 ? largest * 1.08 : 1;
  const x = (t: number): number => left + (t / end) * (width - left - 4);
  const y = (v: number): number => top + (1 - Math.max(0, v) / high) * (height - top - bottom);
  const stride = Math.max(1, Math.floor(times.length / mostPoints));
  const path = (values: number[]): string =>
    values
      .map((v, k) => ({ v, k }))
      .filter(({ k }) => k % stride === 0 || k === values.length - 1)
      .map(({ v, k }, n) => `${n === 0 ? "M" : "L"}${x(times[k]).toFixed(1)} ${y(v).toFixed(1)}`)
      .join("");
  const latest = lines.map(({ values }) => values.at(-1)).filter((v): v is number => v !== undefined);
  return (
    <figure class="plot">
      <figcaption>
        <span>{title}</span>
        <span class="quiet">{unit}</span>
      </figcaption>
      <svg
        viewBox={`0 0 ${width} ${height}`}
        role="img"
        aria-label={`${title} over time, now ${latest.map((v) => v.toFixed(2)).join(" and ")} ${unit}`}
        onClick={(event) => {
          const box = event.currentTarget.getBoundingClientRect();
          onPick?.(Math.max(0, (((event.clientX - box.left) / box.width) * width - left) / (width - left - 4)) * end);
        }}
      >
        {ticks(high).map((tick) => (
          <g key={tick}>
            <line class="grid" x1={left} x2={width - 4} y1={y(tick)} y2={y(tick)} />
            <text x={left - 4} y={y(tick) + 3} text-anchor="end">
              {Number(tick.toPrecision(3))}
            </text>
          </g>
        ))}
        <text x={width - 4} y={height - 3} text-anchor="end">
          {end.toFixed(end < 10 ? 1 : 0)} s
        </text>
        {times.length > 1 &&
          lines.map(({ name, colour, values }) => <path key={name} d={path(values)} style={{ stroke: colour }} />)}
        {now !== undefined && (
          <line class="now" x1={x(Math.min(now, end))} x2={x(Math.min(now, end))} y1={top} y2={height - bottom} />
        )}
      </svg>
    </figure>
  );
}
