// Opens a page of perception-report in a headless browser without network: draws, steps, chooses, switches layers:
//   node check_page.mjs FOLDER_WITH_node_modules PAGE.html [WIDTH [PICTURE.png]]
// node_modules: puppeteer-core; the browser: chromium in the path, or CHROMIUM.
import { createRequire } from "node:module";
import { join, resolve } from "node:path";

const require = createRequire(join(resolve(process.argv[2]), "package.json"));
const puppeteer = require("puppeteer-core");
const width = Number(process.argv[4] ?? 1400);
const check = (truth, what) => {
  if (!truth) throw new Error(what);
  console.log("ok: " + what);
};

const browser = await puppeteer.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--allow-file-access-from-files"],
});
try {
  const page = await browser.newPage(), faults = [], requests = [];
  page.on("pageerror", (error) => faults.push(String(error)));
  page.on("console", (line) => line.type() === "error" && faults.push(line.text()));
  page.on("request", (r) => /^https?:/.test(r.url()) && requests.push(r.url()));
  await page.setOfflineMode(true);
  await page.setViewport({ width, height: width < 600 ? 844 : 1000, isMobile: width < 600, hasTouch: width < 600, deviceScaleFactor: width < 600 ? 2 : 1 });
  await page.goto("file://" + resolve(process.argv[3]), { timeout: 120000 });
  await page.waitForSelector("[data-run][data-ready]", { timeout: 120000 });
  const paint = await page.evaluate(() => performance.getEntriesByType("paint").find((e) => e.name === "first-contentful-paint")?.startTime);
  console.log(`first paint ${Math.round(paint)} ms`);
  check(paint < 2000, "first paint under 2 s");
  const inks = () => page.evaluate(() => {
    const canvas = document.querySelector(".space canvas"), small = document.createElement("canvas");
    small.width = canvas.width;
    small.height = canvas.height;
    const pen = small.getContext("2d");
    pen.drawImage(canvas, 0, 0);
    const data = pen.getImageData(0, 0, small.width, small.height).data;
    let sum = 0;
    for (let i = 0; i < data.length; i += 4) if (data[i] + data[i + 1] + data[i + 2] < 740) ++sum;
    return sum;
  });
  check((await inks()) > 2000, "the space is drawn");
  check(await page.evaluate(() => document.documentElement.scrollWidth <= window.innerWidth), "nothing is wider than the window");

  const state = () => page.evaluate(() => { const v = window.perceptionViewers[0]; return { k: v.k, id: v.id, n: v.run.scenes.length }; });
  const before = await state();
  const slider = await page.$(".transport input");
  await slider.scrollIntoView();
  const box = await slider.boundingBox();
  await page.mouse.move(box.x + 8, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2, { steps: 8 });
  await page.mouse.up();
  const middle = await state();
  check(middle.k !== before.k && Math.abs(middle.k - middle.n / 2) < middle.n * 0.1, "the slider goes to the middle");

  // A click where an object is: the middle of the label nearest to the center of the picture.
  await page.evaluate(() => document.querySelector(".stage").scrollIntoView());
  const spot = await page.evaluate(() => {
    const v = window.perceptionViewers[0], s = v.space, host = s.host.getBoundingClientRect();
    for (const [o, i] of v.run.present[v.k]) {
      if (v.run.classes[o.c[i]].muted) continue;
      const [x, y, z, , , h] = o.row[i], at = s.toScreen(x, y, z + h / 2);
      if (!at || at[0] < 20 || at[1] < 60 || at[0] > host.width - 20 || at[1] > host.height - 20) continue;
      if (s.pick(host.left + at[0], host.top + at[1]) === o.id) return { x: host.left + at[0], y: host.top + at[1], id: o.id };
    }
    return null;
  });
  check(spot !== null, "an object is in the picture");
  await page.mouse.click(spot.x, spot.y);
  check((await state()).id === spot.id, `a click chooses object ${spot.id}`);
  check((await page.$eval(".object h3", (e) => e.textContent)).startsWith(`${spot.id} `), "the panel names it");
  check((await page.$$(".object canvas")).length >= 3, "class, speed and existence are drawn");

  const with_points = await inks(), points = await page.$("input[name=points]");
  if (points) {
    await points.click();
    const without = await inks();
    check(without < with_points, "without the layer of returns there is less on the picture");
    await points.click();
    check((await inks()) === with_points, "and with it as before");
  }
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press("ArrowRight");
  check((await state()).k === middle.k + 1, "the arrow key steps");
  await page.keyboard.press(" ");
  await page.waitForFunction((k) => window.perceptionViewers[0].k > k, { timeout: 20000 }, middle.k + 1);
  await page.keyboard.press(" ");
  console.log("ok: the space key plays");
  if (process.argv[5]) {
    await page.evaluate(() => window.scrollTo(0, 0));
    await page.screenshot({ path: process.argv[5], fullPage: true, captureBeyondViewport: true });
  }
  check(faults.length === 0, "no error in the console " + faults.join("; "));
  check(requests.length === 0, "no request to a network " + requests.join(" "));
} finally {
  await browser.close();
}
