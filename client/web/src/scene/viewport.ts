// A picture of the scene on the page: one WebGL canvas, a camera that is turned by hand, rays under
// the cursor.
import "@kitware/vtk.js/Rendering/OpenGL/Camera";
import "@kitware/vtk.js/Rendering/OpenGL/Renderer";
import "@kitware/vtk.js/Rendering/OpenGL/Actor";
import "@kitware/vtk.js/Rendering/OpenGL/PolyDataMapper";
import vtkInteractorStyleTrackballCamera from "@kitware/vtk.js/Interaction/Style/InteractorStyleTrackballCamera";
import type vtkActor from "@kitware/vtk.js/Rendering/Core/Actor";
import vtkRenderer from "@kitware/vtk.js/Rendering/Core/Renderer";
import vtkRenderWindow from "@kitware/vtk.js/Rendering/Core/RenderWindow";
import vtkRenderWindowInteractor from "@kitware/vtk.js/Rendering/Core/RenderWindowInteractor";
import vtkOpenGLRenderWindow from "@kitware/vtk.js/Rendering/OpenGL/RenderWindow";
import type { Point } from "./surface_geometry";

export interface CameraPose {
  position: Point;
  focus: Point;
  up: Point;
}

const isSamePose = (one: CameraPose, other: CameraPose): boolean =>
  (["position", "focus", "up"] as const).every((part) =>
    one[part].every((value, c) => Math.abs(value - other[part][c]) < 1e-3),
  );

const background: Point = [0.905, 0.925, 0.93];
const darkBackground: Point = [0.06, 0.085, 0.095];

/** A face is so broad for its height. */
const leastAspect = 0.8;

let graphicsCard: boolean | undefined;

/** Without one, smooth edges cost more than they are worth. */
function hasGraphicsCard(): boolean {
  if (graphicsCard === undefined) {
    const gl = document.createElement("canvas").getContext("webgl2");
    const info = gl?.getExtension("WEBGL_debug_renderer_info");
    const name = gl && info ? String(gl.getParameter(info.UNMASKED_RENDERER_WEBGL)) : "";
    graphicsCard = !/swiftshader|llvmpipe|software/i.test(name);
    gl?.getExtension("WEBGL_lose_context")?.loseContext();
  }
  return graphicsCard;
}

export class Viewport {
  private readonly renderWindow = vtkRenderWindow.newInstance();
  private readonly renderer = vtkRenderer.newInstance({ background });
  private readonly gl = vtkOpenGLRenderWindow.newInstance();
  private readonly interactor = vtkRenderWindowInteractor.newInstance();
  private readonly resizing: ResizeObserver;
  private due = 0;
  /** told after every picture */
  onRendered: () => void = () => undefined;
  /** all others that are told after every picture */
  readonly onDrawn = new Set<() => void>();
  /** told when the camera was moved, by hand or by the page */
  onCamera: (pose: CameraPose) => void = () => undefined;
  /** told when it was moved by hand */
  onTurned: (pose: CameraPose) => void = () => undefined;
  /** where the page has put the camera */
  private put: CameraPose | undefined;
  private following = false;
  private sharpness = 1;

  constructor(readonly container: HTMLElement) {
    this.renderWindow.addRenderer(this.renderer);
    this.renderWindow.addView(this.gl);
    const canvas = this.gl.getCanvas()!;
    canvas.getContext("webgl2", {
      antialias: hasGraphicsCard(),
      depth: true,
      alpha: false,
      powerPreference: "high-performance",
    });
    this.gl.setContainer(container);
    this.interactor.setView(this.gl);
    this.interactor.initialize();
    this.interactor.bindEvents(container);
    this.interactor.setInteractorStyle(vtkInteractorStyleTrackballCamera.newInstance());
    this.renderer.getActiveCamera().setViewAngle(24);
    this.renderer.getActiveCamera().onModified(() => this.cameraMoved());
    this.interactor.onAnimation(() => this.cameraMoved());
    this.resizing = new ResizeObserver(() => this.fit());
    this.resizing.observe(container);
    this.fit();
  }

  private fit(): void {
    const { width, height } = this.container.getBoundingClientRect();
    const ratio = this.sharpness * Math.min(window.devicePixelRatio || 1, 2);
    this.gl.setSize(Math.max(1, Math.round(width * ratio)), Math.max(1, Math.round(height * ratio)));
    const canvas = this.gl.getCanvas();
    if (canvas) Object.assign(canvas.style, { width: "100%", height: "100%", display: "block" });
    this.request();
  }

  /**
   * Pixels of the picture to those of the screen; fewer where a machine is too slow for all of
   * them.
   */
  set detail(share: number) {
    if (share === this.sharpness) return;
    this.sharpness = share;
    this.fit();
  }

  /** The picture has a dark background, for a dim room. */
  set dark(wanted: boolean) {
    this.renderer.setBackground(...(wanted ? darkBackground : background));
    this.request();
  }

  private cameraMoved(): void {
    const { pose } = this;
    if (!this.following) this.onCamera(pose);
    // A picture fits the depths that the camera sees, which is no turn.
    if (!this.following && this.put && !isSamePose(pose, this.put)) this.onTurned(pose);
    this.request();
  }

  add(actor: vtkActor): void {
    this.renderer.addActor(actor);
  }
  remove(actor: vtkActor): void {
    this.renderer.removeActor(actor);
  }

  /** A picture soon: as many requests as come before the next refresh of the screen make one. */
  request(): void {
    if (this.due === 0) this.due = requestAnimationFrame(() => this.render());
  }

  render(): void {
    cancelAnimationFrame(this.due);
    this.due = 0;
    this.renderer.resetCameraClippingRange();
    this.renderWindow.render();
    this.onRendered();
    this.onDrawn.forEach((tell) => tell());
  }

  get pose(): CameraPose {
    const camera = this.renderer.getActiveCamera();
    return {
      position: [...camera.getPosition()] as Point,
      focus: [...camera.getFocalPoint()] as Point,
      up: [...camera.getViewUp()] as Point,
    };
  }

  /** As another viewport is turned. */
  set pose(pose: CameraPose) {
    const camera = this.renderer.getActiveCamera();
    [this.following, this.put] = [true, pose];
    camera.setPosition(...pose.position);
    camera.setFocalPoint(...pose.focus);
    camera.setViewUp(...pose.up);
    this.following = false;
    this.request();
  }

  /** Looks at a place from a direction, so that `halfHeight` [mm] fits above and below it. */
  lookAt(focus: Point, direction: Point, up: Point, halfHeight: number): void {
    const { width, height } = this.container.getBoundingClientRect();
    // In a narrow picture the sides of the face would be cut off.
    const further = width > 0 ? Math.max(1, (leastAspect * height) / width) : 1;
    const distance = (further * halfHeight) / Math.tan(((24 / 2) * Math.PI) / 180);
    this.pose = { focus, up, position: [0, 1, 2].map((c) => focus[c] + distance * direction[c]) as Point };
    this.onCamera(this.pose);
  }

  /** Puts the camera, and those that are turned as it is. */
  set placed(pose: CameraPose) {
    this.pose = pose;
    this.onCamera(pose);
  }

  /** Turns the camera around what it looks at [degrees]. */
  turn(azimuth: number, elevation: number): void {
    const camera = this.renderer.getActiveCamera();
    camera.azimuth(azimuth);
    camera.elevation(elevation);
    camera.orthogonalizeViewUp();
  }

  /** Comes nearer by a factor above 1, goes away by one below. */
  approach(factor: number): void {
    this.renderer.getActiveCamera().dolly(factor);
  }

  private scale(): number {
    return this.gl.getSize()[0] / Math.max(1, this.container.clientWidth);
  }

  /** The ray under a place on the screen: where it starts, and a unit vector. */
  rayAt(clientX: number, clientY: number): { from: Point; along: Point } {
    const box = this.container.getBoundingClientRect();
    const [x, y] = [(clientX - box.left) * this.scale(), this.gl.getSize()[1] - (clientY - box.top) * this.scale()];
    const near = this.gl.displayToWorld(x, y, 0, this.renderer) as Point;
    const far = this.gl.displayToWorld(x, y, 1, this.renderer) as Point;
    const along = [0, 1, 2].map((c) => far[c] - near[c]) as Point;
    const length = Math.hypot(...along);
    return { from: near, along: along.map((v) => v / length) as Point };
  }

  /** Where a point is on the page, in CSS pixels of the container. */
  project(point: Point): { x: number; y: number } {
    const [x, y] = this.gl.worldToDisplay(...point, this.renderer);
    return { x: x / this.scale(), y: (this.gl.getSize()[1] - y) / this.scale() };
  }

  /** The picture as it is, PNG. */
  capture(): Promise<Blob> {
    this.render();
    // Before the browser takes what was drawn.
    return new Promise((resolve, reject) =>
      this.canvas().toBlob(
        (blob) => (blob ? resolve(blob) : reject(new Error("the picture cannot be taken"))),
        "image/png",
      ),
    );
  }

  canvas(): HTMLCanvasElement {
    return this.gl.getCanvas()!;
  }

  dispose(): void {
    cancelAnimationFrame(this.due);
    this.resizing.disconnect();
    this.interactor.unbindEvents();
    this.interactor.delete();
    this.renderWindow.removeRenderer(this.renderer);
    this.gl.setContainer(null as never);
    this.gl.delete();
  }
}
