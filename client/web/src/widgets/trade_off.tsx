// Closeness to the goal against volume: points to pick from, as a curve and as a list.
import type { TradeOff } from "@wire/planning_service_pb";
import { bandOf, cssOf, mmHgPerPa, pressureBands } from "../scene/colour_maps";

interface Props {
  /** from the least volume to the most */
  curve: TradeOff[];
  proposed: number;
  picked: number | undefined;
  onPick: (point: number) => void;
}

const [width, height, left, right, top, bottom] = [260, 120, 34, 14, 10, 26];

/** Ends of an axis that has all values with some room. */
function ends(values: number[]): [number, number] {
  const [low, high] = [Math.min(...values), Math.max(...values)];
  const room = Math.max(0.15 * (high - low), 0.05 * high, 1e-3);
  return [Math.max(0, low - room), high + room];
}

const colourOf = ({ maxPressurePa }: TradeOff): string =>
  cssOf(pressureBands[bandOf(maxPressurePa * mmHgPerPa)].colour);

function Picture({ curve, proposed, picked, onPick }: Props) {
  const [fromX, toX] = ends(curve.map(({ totalMl }) => totalMl));
  const [fromY, toY] = ends(curve.map(({ rmsMm }) => rmsMm));
  const x = (ml: number): number => left + ((ml - fromX) / (toX - fromX)) * (width - left - right);
  const y = (mm: number): number => top + (1 - (mm - fromY) / (toY - fromY)) * (height - top - bottom);
  const line = curve.map(({ totalMl, rmsMm }) => `${x(totalMl).toFixed(1)},${y(rmsMm).toFixed(1)}`).join(" ");
  return (
    <svg viewBox={`0 0 ${width} ${height}`} aria-hidden="true" class="trade-off">
      <line class="grid" x1={left} x2={left} y1={top} y2={height - bottom} />
      <line class="grid" x1={left} x2={width - right} y1={height - bottom} y2={height - bottom} />
      <text x={left - 4} y={top + 4} text-anchor="end">
        {toY.toFixed(1)}
      </text>
      <text x={left - 4} y={height - bottom} text-anchor="end">
        {fromY.toFixed(1)}
      </text>
      <text x={left} y={height - 12} text-anchor="middle">
        {fromX.toFixed(1)}
      </text>
      <text x={width - right} y={height - 12} text-anchor="end">
        {toX.toFixed(1)} mL
      </text>
      <text x={width - right} y={top + 4} text-anchor="end">
        mm from the goal (RMS)
      </text>
      <polyline points={line} />
      {curve.map((point, index) => (
        <circle
          key={index}
          cx={x(point.totalMl)}
          cy={y(point.rmsMm)}
          r={index === picked ? 7 : 5}
          class={index === picked ? "picked" : index === proposed ? "proposed" : ""}
          style={{ fill: colourOf(point) }}
          onClick={() => onPick(index)}
        />
      ))}
    </svg>
  );
}

export function TradeOffCurve(props: Props) {
  const { curve, proposed, picked, onPick } = props;
  return (
    <div class="trade-off-box">
      {curve.length > 1 && <Picture {...props} />}
      <div class="points" role="radiogroup" aria-label="Volume against closeness to the goal">
        {curve.map((point, index) => (
          <label class="point" key={index}>
            <input type="radio" name="trade-off" checked={index === picked} onChange={() => onPick(index)} />
            <b>
              {point.totalMl.toFixed(1)} mL
              {index === proposed && <small>proposed</small>}
            </b>
            <span>{point.rmsMm.toFixed(2)} mm off</span>
            <span>
              <i class="swatch" style={{ background: colourOf(point) }} aria-hidden="true" />{" "}
              {(point.maxPressurePa * mmHgPerPa).toFixed(0)} mmHg
            </span>
          </label>
        ))}
      </div>
    </div>
  );
}
