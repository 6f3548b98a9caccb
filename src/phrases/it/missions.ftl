# Le pagine delle missioni: l'elenco, una di esse, e il suo recupero.

missions-title = Missioni
missions-of = Missione { $id }
missions-times = Gli orari sono in { $zone }.
missions-pages = Pagine

## L'elenco

missions-newest-first = Missioni, dalla più recente
missions-none = Nessuna missione è ancora cominciata. Premere AVVIA sulla console.
missions-none-older = Non ci sono missioni più vecchie.
missions-began = Inizio
missions-archived = Archiviata
missions-came-to = Esito
missions-pieces = Bagagli
missions-dangerous = Pericolosi
missions-not-yet = non ancora
missions-newest = Le più recenti
missions-older = Missioni più vecchie

## L'esito di una missione

missions-searched = Tutta la sala è stata esplorata
missions-searched-of = Tutto ciò che si raggiunge dalla partenza è stato esplorato: { $reachable } celle libere su { $free }
missions-searched-reachable = Tutto ciò che si raggiunge dalla partenza è stato esplorato
missions-bomb-located = Una bomba è stata localizzata
missions-bomb-secured = La bomba è stata recuperata e messa al sicuro
missions-under-way = In corso: { $phase }
missions-archived-while = Archiviata nella fase: { $phase }
missions-left = { $outcome }; rimasto sul posto: bagaglio { $which }

## Una di esse

missions-luggage = Bagagli
missions-luggage-count = { $count }, di cui pericolosi: { $dangerous }
missions-zone = Orari
missions-in-zone = in { $zone }
missions-its-trees = Alberi di comportamento del recupero
receipts-link = Consegne
receipts-title = Consegne della missione { $mission }
receipts-none = Questa missione non è stata consegnata a nessuno.
receipts-no-later = Non ci sono consegne successive.
receipts-later = Consegne successive
receipt-to = Ricevuta della consegna a { $to }
receipt-time = Quando
receipt-by = Consegnata da
receipt-code = Codice
receipt-no-code = nessuno, perché questo registro non è conservato su disco
receipt-how = Per verificare che il registro fino a questa consegna non sia stato modificato:
receipt-handed-over = Firma di chi consegna
receipt-received = Firma di chi riceve
missions-conditions = Condizioni
missions-report = Scaricare il rapporto
missions-cells-visited = Celle visitate
missions-missing = Che cosa manca qui
missions-damaged = Una parte di ciò che è registrato di questa missione è danneggiata. La pagina mostra il resto, senza ciò che dipende dalla parte danneggiata:
missions-replay = Rivedere questa missione
missions-hall-known = La parte nota della sala
missions-no-luggage = Non ne è stato incontrato nessuno.
missions-not-kept = La mappa e i bagagli di questa missione non sono conservati.
missions-happened = Che cosa è successo, dal principio
missions-show-main = Che cosa è stato fatto e trovato
missions-show-commands = Solo i comandi
missions-show-all = Ogni passo
missions-nothing = Non ci sono eventi di questo tipo.
missions-as-it-stood = la sala in quel momento
missions-by = da { $who }:
missions-from-beginning = Dal principio
missions-further = Voci successive

## La legenda della sala


## Il recupero

missions-retrieval-in = Recupero nella missione { $id }
missions-fetched-by-pair = Recupero del bagaglio #{ $luggage } da parte della coppia
missions-fetched-alone = Recupero del bagaglio #{ $luggage } da parte del robot della ricerca
missions-trees-stood = Alberi di comportamento
missions-moment = { $seconds } s dopo l'inizio del recupero, momento { $moment } di { $last }
missions-incomplete = Non si può mostrare tutto ciò che è registrato di questo recupero: il registro è troppo lungo o danneggiato.
missions-no-trees = Questo recupero non ha usato alberi di comportamento.
missions-moment-first = Primo
missions-moment-previous = Precedente
missions-moment-next = Successivo
missions-moment-last = Ultimo
missions-seconds-since = I tempi sono secondi dall'inizio del recupero, secondo l'orologio. Gli stessi dati per i programmi:
bundle-photo-lost = La foto { $take } del bagaglio #{ $id } è perduta.
bundle-readme =
    Missione { $mission }, come l’ha registrata hallsweep.

    report.html    il rapporto: la sala, tutti i bagagli con foto e verdetti, allarmi, comandi, eventi
    entries.jsonl  ogni voce di questa missione, un oggetto JSON per riga
    photos         tutte le foto, con il numero del bagaglio e della foto
    SHA256SUMS     lo SHA-256 di ciascuno di questi file

    Per controllare i file non serve hallsweep. Estrarli, e in questa cartella eseguire

    sha256sum -c SHA256SUMS

    Così si vede che i file sono quelli dell’elenco. Che l’elenco sia quello consegnato lo mostra lo SHA-256
    dell’elenco stesso, annotato quando il pacchetto è stato fatto:

    sha256sum SHA256SUMS

    In Windows, certutil -hashfile FILE SHA256 calcola lo SHA-256 di un file.

    Chi ha il giornale può anche confrontare il rapporto con esso: hallsweep journal check --report report.html
