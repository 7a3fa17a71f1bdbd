// Draws formulas, a list in JSON, and prints what KaTeX, whose folder is given, complains about: node draw.js KATEX < formulas
const katex = require(require("path").resolve(process.argv[2]));
const complaints = [];
for (const formula of JSON.parse(require("fs").readFileSync(0))) {
    try {
        katex.renderToString(formula, { displayMode: true, strict: "error" });
    } catch (error) {
        complaints.push(`${formula.trim()}: ${error.message}`);
    }
}
console.log(JSON.stringify(complaints));
