// The labels of a dataset's frames as JSON, by the package that Roboflow imports annotations with: it finds out
// by itself which format a file has. {COCO: {picture: [box]}, YOLO: {picture: [box]}}; a box has a label, its
// centre, its size and perhaps a polygon.
import { createRequire } from "node:module";
import { readdirSync, readFileSync } from "node:fs";

const require = createRequire(process.argv[2] + "/");
const Annotation = require("@roboflow/annotation");
const form = process.argv[3];
const classes = Annotation.parseLabelMap(readFileSync(form + "/../classes.txt", "utf8"), "txt");

function parsed(name, extension, type) {
  const text = readFileSync(form + "/" + name, "utf8");
  const found = Annotation.parse(text, name.split("/").pop(), extension, classes);
  for (const { info, error, warning } of found) {
    if (info.type !== type || error || warning) throw new Error(JSON.stringify([name, info, error, warning]));
  }
  return found.map(({ annotation }) => [annotation.key, annotation.converted.boxes]);
}

const coco = parsed("annotations.json", "json", "COCO").map(([keys, boxes]) => [keys[0], boxes]);
const yolo = readdirSync(form + "/labels").map((name) => {
  const [[keys, boxes]] = parsed("labels/" + name, "txt", "YoloDarknet");
  return [keys.find((key) => key.endsWith(".png")), boxes];
});
console.log(JSON.stringify({ COCO: Object.fromEntries(coco), YOLO: Object.fromEntries(yolo) }));
