// Reads a glTF or GLB from the path given and prints the validator's report as JSON.
const fs = require("fs");
const validator = require("gltf-validator");

const data = new Uint8Array(fs.readFileSync(process.argv[2]));
validator
  .validateBytes(data, { maxIssues: 100, uri: process.argv[2] })
  .then((report) => process.stdout.write(JSON.stringify(report)))
  .catch((error) => { process.stderr.write(String(error)); process.exit(1); });
