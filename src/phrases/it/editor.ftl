# L'editor delle sale. Quello che dice anche il suo script sta con gli script.

halls-title = Editor delle sale
halls-to-simulator = Al simulatore
halls-viewer = Accesso come osservatore: si vede la sala e si può premere STOP. Per tutto il resto serve la chiave di un operatore.

## Il disegno.

halls-drawing = Disegno
halls-tool = Strumento
halls-wall = Parete
halls-floor = Pavimento
halls-luggage = Bagaglio
halls-dangerous = Pericoloso
halls-home = Base
halls-area = Area
halls-shape = Forma da disegnare
halls-brush = Pennello
halls-line = Linea
halls-rectangle = Rettangolo
halls-undo = Annulla
halls-redo = Ripristina
halls-drawing-about = Disegnare con il puntatore o con il dito. Con la tastiera le frecce muovono il cursore e lo spazio disegna; per una linea o un rettangolo lo spazio serve due volte. <kbd>c</kbd> annulla una linea o un rettangolo non finiti. La lettera accanto a uno strumento lo sceglie.
halls-plan = Pianta della sala
halls-areas = Aree
halls-areas-about = Con lo strumento <i>Area</i> un rettangolo è un'area. <i>Linea</i> disegna ogni altro contorno: ogni pressione aggiunge un vertice, e una pressione sul primo vertice chiude il contorno. La probabilità dice quanto è probabile che la bomba sia in quest'area; tutte le aree insieme hanno al massimo 1. Le aree non si sovrappongono.
halls-area-name = Nome dell'area
halls-area-probability = Probabilità
halls-name = Nome
halls-columns = Colonne
halls-rows = Righe
halls-size = Impostare nome e dimensioni
halls-open = Aprire un file
halls-resolution = Metri per pixel (immagine senza YAML)
halls-download = Scaricare

## Il file.

halls-file = La sala come file
halls-file-about = Nel disegno <code>.</code> è pavimento, <code>#</code> è parete, <code>S</code> è la base, e le altre lettere sono bagagli. <code>dangerous = true</code> segna un bagaglio pericoloso. <code>[[area]]</code> comincia un'area con un nome.
halls-check = Controllare
halls-use = Usare questa sala
halls-another = Cominciare da un'altra sala

## Halls that are kept.

halls-keep-as = Conservare come
halls-keep-as-about = lettere minuscole, cifre e -
halls-keep = Conservare
halls-replace = Sostituire { $name }
halls-kept = Sale conservate nella cartella dei dati
halls-discard = Eliminare { $name }…
halls-discard-asked = Eliminare <b>{ $name }</b>? La sala conservata va persa. La sala nell'editor resta.
halls-discard-for-good = Eliminare { $name } per sempre
halls-discarded = La sala conservata <b>{ $name }</b> è stata eliminata.
halls-another-kept = Un'altra sala è conservata come <b>{ $name }</b>: sostituirla, o scegliere un altro nome.
halls-opened = Questa è la sala conservata come <b>{ $name }</b>.
