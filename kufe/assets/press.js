// The page of `kufe press`.
contactPage(document.getElementById("main")).show(pageData());
