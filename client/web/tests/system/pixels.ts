// What is in a picture of the page, looked at in the browser itself.
import type { Page } from "playwright-core";

export interface Box {
  x: number;
  y: number;
  width: number;
  height: number;
}

interface Pixels {
  ofHue(image: string, box: Box, colour: number[]): Promise<number>;
  differ(one: string, other: string, box: Box, threshold: number): Promise<number>;
}

/** Runs in the browser. */
const inBrowser = (): Pixels => {
  const read = async (image: string, box: Box): Promise<Uint8ClampedArray> => {
    const bitmap = await createImageBitmap(await (await fetch(`data:image/png;base64,${image}`)).blob());
    const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d")!;
    context.drawImage(bitmap, 0, 0);
    return context.getImageData(box.x, box.y, box.width, box.height).data;
  };
  const angle = (r: number, g: number, b: number): number => Math.atan2(Math.sqrt(3) * (g - b), 2 * r - g - b);
  return {
    async ofHue(image, box, [r, g, b]) {
      const data = await read(image, box);
      const wanted = angle(r, g, b);
      let found = 0;
      for (let k = 0; k < data.length; k += 4) {
        const [x, y, z] = [data[k], data[k + 1], data[k + 2]];
        const apart = angle(x, y, z) - wanted;
        if (Math.max(x, y, z) - Math.min(x, y, z) > 60 && Math.cos(apart) > 0.98) ++found;
      }
      return found;
    },
    async differ(one, other, box, threshold) {
      const [a, b] = [await read(one, box), await read(other, box)];
      let found = 0;
      for (let k = 0; k < a.length; k += 4)
        if ([0, 1, 2].some((i) => Math.abs(a[k + i] - b[k + i]) > threshold)) ++found;
      return found;
    },
  };
};

interface WithPixels {
  pixels: Pixels;
}

export class PictureReader {
  private constructor(private readonly page: Page) {}

  static async open(page: Page): Promise<PictureReader> {
    // In a window of its own: a tab behind another one is not drawn.
    const blank = await page.context().browser()!.newPage();
    await blank.evaluate(`window.pixels = (${inBrowser.toString()})()`);
    await page.bringToFront();
    return new PictureReader(blank);
  }

  /**
   * Pixels whose hue is that of `colour`, however the scene's light makes it brighter or darker.
   */
  ofHue(image: Buffer, box: Box, colour: number[]): Promise<number> {
    return this.page.evaluate(([data, where, of]) => (window as unknown as WithPixels).pixels.ofHue(data, where, of), [
      image.toString("base64"),
      box,
      colour,
    ] as [string, Box, number[]]);
  }

  /** Pixels that two pictures do not share. */
  differ(one: Buffer, other: Buffer, box: Box, threshold = 24): Promise<number> {
    return this.page.evaluate(
      ([a, b, where, least]) => (window as unknown as WithPixels).pixels.differ(a, b, where, least),
      [one.toString("base64"), other.toString("base64"), box, threshold] as [string, string, Box, number],
    );
  }
}
