// Writes the page as one file: node build.mjs PACKED_SIMULATOR NODE_MODULES OUT

import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const [simulator, modules, out] = process.argv.slice(2).map((path) => resolve(path));
const { build } = createRequire(join(modules, "here"))("esbuild");

const bundled = async (entry, options) =>
  (await build({ entryPoints: [join(here, entry)], bundle: true, minify: true, write: false, ...options })).outputFiles[0].text;
const script = await bundled("main.js", {
  format: "iife",
  target: "es2022",
  nodePaths: [modules],
  alias: { "simulator.wasm.gz": simulator },
  loader: { ".gz": "binary" },
});
const style = await bundled("page.css");
const licence = readFileSync(join(modules, "three/LICENSE"), "utf8").trim();
const page = readFileSync(join(here, "page.html"), "utf8")
  .replace("<!--LICENCES-->", () => `<!-- In this page: Eigen (MPL-2.0, https://eigen.tuxfamily.org) and three.js.\n\n${licence}\n-->`)
  .replace("/*STYLE*/", () => style)
  .replace("/*SCRIPT*/", () => script);
writeFileSync(out, page);
