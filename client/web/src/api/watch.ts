// Frames of a simulation, as they come, through lost connections and restarts of the daemon.
import { Code, ConnectError } from "@connectrpc/connect";
import { ArrayType, type WatchResponse } from "@wire/frame_service_pb";
import { ArrayAssembler, type WireArray } from "./arrays";
import { frames, newId } from "./client";
import { isLost } from "./errors";
import { meshesOf, type Mesh } from "./meshes";

export interface Frame {
  epoch: bigint;
  sequence: bigint;
  timeS: number;
  preview: boolean;
  end: boolean;
  fields: Map<string, WireArray>;
}

export interface Listener {
  /** before the first frame, and when they are others */
  meshes(meshes: Map<string, Mesh>): void;
  frame(frame: Frame, skipped: number): void;
  /** "live" once something came, "lost" while the connection is tried again */
  connection(state: "live" | "lost"): void;
}

/** What of a simulation has been seen. */
export interface Seen {
  epoch: bigint;
  sequence: bigint;
  /** the meshes that are here; empty: none */
  topology: string;
}

export interface WatchOptions {
  simulation: string;
  fields: string[];
  maxRateHz: number;
  /** goes on from there: a simulation that had ended may go on */
  seen?: Seen;
  signal: AbortSignal;
}

const heartbeatMs = 2000;
/** So many heartbeats missing are a broken stream. */
const patience = 4;
const window = 8;
const longestPauseMs = 5000;

/** Ends the stream when nothing came for long. */
class SilenceWatch {
  private timer: ReturnType<typeof setTimeout> | undefined;
  readonly controller = new AbortController();

  constructor(private readonly outer: AbortSignal) {
    outer.addEventListener("abort", this.abort);
    this.heard();
  }
  private abort = (): void => this.controller.abort();
  heard(): void {
    clearTimeout(this.timer);
    this.timer = setTimeout(this.abort, heartbeatMs * patience);
  }
  end(): void {
    clearTimeout(this.timer);
    this.outer.removeEventListener("abort", this.abort);
    this.controller.abort();
  }
}

/** Where a stream has come to, so that the next one goes on from there. */
class Progress {
  epoch = 0n;
  sequence = 0n;
  topology = "";
  ended = false;
  private readonly viewer = newId();
  private assembler = new ArrayAssembler();
  private unacknowledged = 0;

  constructor(
    private readonly options: WatchOptions,
    private readonly listener: Listener,
  ) {
    Object.assign(this, options.seen);
  }

  get seen(): Seen {
    return { epoch: this.epoch, sequence: this.sequence, topology: this.topology };
  }

  request() {
    const { simulation, fields, maxRateHz } = this.options;
    return {
      simulation,
      fields,
      maxRateHz,
      heartbeatMs,
      viewer: this.viewer,
      fieldType: ArrayType.UINT16,
      maxUnacknowledgedFrames: window,
      seenEpoch: this.epoch,
      seenSequence: this.sequence,
      knownTopologyHash: this.topology,
    };
  }

  restart(): void {
    this.assembler = new ArrayAssembler();
    this.unacknowledged = 0;
  }

  take(response: WatchResponse): void {
    const { message } = response;
    if (message.case === "mesh") {
      message.value.arrays.forEach((array) => this.assembler.add(array));
      if (!message.value.last) return;
      this.listener.meshes(meshesOf(this.assembler.take()));
      this.topology = message.value.topologyHash;
    } else if (message.case === "frame") {
      const { epoch, sequence, timeS, preview, end, fields, last, skippedFrames } = message.value;
      fields.forEach((array) => this.assembler.add(array));
      if (!last) return;
      [this.epoch, this.sequence, this.ended] = [epoch, sequence, end];
      this.listener.frame(
        { epoch, sequence, timeS, preview, end, fields: this.assembler.take() },
        Number(skippedFrames),
      );
      if (!end) this.acknowledge();
    }
  }

  /**
   * Half a window at a time: frames go on coming, and a page that falls behind is never more than a
   * window old.
   */
  private acknowledge(): void {
    if (++this.unacknowledged < window / 2) return;
    this.unacknowledged = 0;
    const { simulation } = this.options;
    // What is lost with the connection is acknowledged by coming back; that the viewer is gone
    // shows in the stream.
    frames
      .acknowledgeFrame({ simulation, viewer: this.viewer, epoch: this.epoch, sequence: this.sequence })
      .catch(() => undefined);
  }
}

const pause = (ms: number): Promise<void> => new Promise((resolve) => setTimeout(resolve, ms));

/**
 * Returns after the last frame, or when `signal` aborts, what has been seen.
 * @throws ConnectError for anything but a lost connection
 */
export async function watch(options: WatchOptions, listener: Listener): Promise<Seen> {
  const progress = new Progress(options, listener);
  for (let failures = 0; !progress.ended && !options.signal.aborted; ) {
    const silence = new SilenceWatch(options.signal);
    progress.restart();
    try {
      for await (const response of frames.watch(progress.request(), { signal: silence.controller.signal })) {
        silence.heard();
        failures = 0;
        listener.connection("live");
        progress.take(response);
      }
      if (progress.ended) return progress.seen;
    } catch (error) {
      const code = ConnectError.from(error).code;
      const silenced = code === Code.Canceled || code === Code.Aborted;
      if (options.signal.aborted) return progress.seen;
      if (!silenced && !isLost(error)) throw error;
    } finally {
      silence.end();
    }
    listener.connection("lost");
    await pause(Math.min(longestPauseMs, 250 * 2 ** failures++));
  }
  return progress.seen;
}
