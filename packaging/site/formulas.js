// KaTeX typesets the formulas, which Arithmatex marks as \(...\) and \[...\].
renderMathInElement(document.body);
